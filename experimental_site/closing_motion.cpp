#include "experimental_site/closing_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hybridtest {

ClosingMotion::ClosingMotion(const ClosingMotionSettings& settings, int dofs) noexcept
    : settings_{settings}, begin_m_{SiteVector::Zero(dofs)}, velocity_m_per_s_{begin_m_}, displacement_m_{begin_m_} {}

void ClosingMotion::begin(const SiteVector& displacement_m, const SiteVector& velocity_m_per_s, bool returns) noexcept {
  returns_ = returns;
  begin_m_ = displacement_m;
  displacement_m_ = displacement_m;
  velocity_m_per_s_ = velocity_m_per_s;
  period_ = 0;
  const bool moves = !velocity_m_per_s.isZero(0.0);
  halt_periods_ = moves ? static_cast<std::int64_t>(std::ceil(settings_.halt_s / settings_.period_s)) : 0;
  return_periods_ = returns ? 1 : 0;  // set when the return begins
  if (halt_periods_ == 0) begin_return();
}

void ClosingMotion::advance() noexcept {
  if (is_over()) return;
  ++period_;
  if (period_ <= halt_periods_) {
    halt();
    if (period_ == halt_periods_) begin_return();
    return;
  }
  const double x = static_cast<double>(period_ - halt_periods_) / static_cast<double>(return_periods_);
  displacement_m_ = (0.5 * (1.0 + std::cos(std::numbers::pi * x))) * begin_m_;
}

void ClosingMotion::halt() noexcept {
  const double time_s = static_cast<double>(period_) * settings_.period_s;
  const double whole_s = static_cast<double>(halt_periods_) * settings_.period_s;
  const double limit_m = settings_.displacement_limit_m;
  displacement_m_ =
      (begin_m_ + (time_s * (1.0 - 0.5 * time_s / whole_s)) * velocity_m_per_s_).cwiseMax(-limit_m).cwiseMin(limit_m);
}

void ClosingMotion::begin_return() noexcept {
  if (!returns_) return;
  begin_m_ = displacement_m_;
  // The highest velocity of a raised cosine is pi/2 times its mean; the return stays below half the limit.
  const double return_s_min = std::numbers::pi * begin_m_.cwiseAbs().maxCoeff() / settings_.velocity_limit_m_per_s;
  const double periods = std::ceil(std::max(settings_.return_time_s, return_s_min) / settings_.period_s);
  return_periods_ =
      std::max<std::int64_t>(1, static_cast<std::int64_t>(periods));  // one period even where the distance is zero
}

}  // namespace hybridtest
