#include "experimental_site/fading_offset.hpp"

namespace hybridtest {
namespace {

/// A remaining duration below this share is zero up to the rounding of the sum of the intervals.
constexpr double kRounding = 1e-9;

}  // namespace

FadingOffset::FadingOffset(int dofs) noexcept
    : begin_displacement_m_{SiteVector::Zero(dofs)},
      begin_velocity_m_per_s_{begin_displacement_m_},
      displacement_m_{begin_displacement_m_},
      velocity_m_per_s_{begin_displacement_m_} {}

void FadingOffset::begin(const SiteVector& displacement_m, const SiteVector& velocity_m_per_s,
                         double duration_s) noexcept {
  begin_displacement_m_ = displacement_m;
  begin_velocity_m_per_s_ = velocity_m_per_s;
  duration_s_ = duration_s;
  since_s_ = 0.0;
  is_over_ = displacement_m.isZero(0.0) && velocity_m_per_s.isZero(0.0);
  evaluate();
}

void FadingOffset::end() noexcept {
  is_over_ = true;
  evaluate();
}

void FadingOffset::advance(double interval_s) noexcept {
  if (is_over_) return;
  since_s_ += interval_s;
  is_over_ = since_s_ >= duration_s_ * (1.0 - kRounding);
  evaluate();
}

void FadingOffset::evaluate() noexcept {
  if (is_over_) {
    displacement_m_.setZero();
    velocity_m_per_s_.setZero();
    return;
  }
  const double x = since_s_ / duration_s_;
  const double left = 1.0 - x;
  displacement_m_ = left * left * ((1.0 + 2.0 * x) * begin_displacement_m_ + x * duration_s_ * begin_velocity_m_per_s_);
  velocity_m_per_s_ =
      left * ((-6.0 * x / duration_s_) * begin_displacement_m_ + (1.0 - 3.0 * x) * begin_velocity_m_per_s_);
}

}  // namespace hybridtest
