#include "compensation/delay_estimators/recursive_least_squares.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {
namespace {

constexpr double kGainMin = 0.2;
// r and r' of a steady motion are orthogonal; where they are nearly parallel, as in a single ramp, delay
// and gain cannot be told apart.
constexpr double kIndependenceMin = 1e-3;

}  // namespace

RecursiveLeastSquares::RecursiveLeastSquares(const Parameters& parameters, double control_period_s)
    : DelayEstimator{parameters.limits, control_period_s},
      parameters_{checked(parameters)},
      keep_{std::exp(-control_period_s / parameters.memory_s)},
      references_m_{checked_periods("delay_s_max", parameters.limits.delay_s_max, control_period_s, 1,
                                    "the references of the longest delay are kept") +
                    4},
      expansion_s_{parameters.limits.initial_delay_s} {}

void RecursiveLeastSquares::observe(const DelaySample& sample) noexcept {
  references_m_.push(sample.reference_m);
  accumulate(sample);
  if (rr_ < parameters_.motion_m_min * parameters_.motion_m_min) return;
  const double determinant = rr_ * vv_ - rv_ * rv_;
  // Written so that a reference that has not moved yet, with r' = 0 and both sides zero, returns too.
  if (!(determinant > kIndependenceMin * rr_ * vv_)) return;
  const double gain = (rm_ * vv_ - vm_ * rv_) / determinant;
  if (!(gain >= kGainMin)) return;
  gain_ = gain;
  const double error_s = -(vm_ * rr_ - rm_ * rv_) / determinant / gain;
  const double wanted_s = std::clamp(expansion_s_ + error_s, limits().delay_s_min, limits().delay_s_max);
  // The expansion holds near d only: d goes there no faster than the estimate itself may.
  const double step_s = limits().rate_s_per_s_max * control_period_s();
  move_expansion(std::clamp(wanted_s - expansion_s_, -step_s, step_s));
  believe(expansion_s_);
}

void RecursiveLeastSquares::accumulate(const DelaySample& sample) noexcept {
  // The difference needs a sample on either side; with a delay of less than one, the newest two serve.
  const double age = expansion_s_ / control_period_s();
  const auto whole = static_cast<std::size_t>(age);
  const double part = age - static_cast<double>(whole);
  const auto value = [this](std::size_t at, double beyond) {
    return references_m_[at] + beyond * (references_m_[at + 1] - references_m_[at]);
  };
  const std::size_t newer = whole == 0 ? 0 : whole - 1;
  const double span_s = static_cast<double>(whole + 1 - newer) * control_period_s();
  const double r = value(whole, part);
  const double v = (value(newer, part) - value(whole + 1, part)) / span_s;
  const double m = sample.measured_displacement_m;
  const double fresh = 1.0 - keep_;
  rr_ = keep_ * rr_ + fresh * r * r;
  rv_ = keep_ * rv_ + fresh * r * v;
  vv_ = keep_ * vv_ + fresh * v * v;
  rm_ = keep_ * rm_ + fresh * r * m;
  vm_ = keep_ * vm_ + fresh * v * m;
}

void RecursiveLeastSquares::move_expansion(double by_s) noexcept {
  expansion_s_ += by_s;
  rr_ += by_s * (by_s * vv_ - 2.0 * rv_);
  rv_ -= by_s * vv_;
  rm_ -= by_s * vm_;
}

void RecursiveLeastSquares::forget() noexcept {
  references_m_.clear();
  expansion_s_ = limits().initial_delay_s;
  gain_ = 1.0;
  rr_ = rv_ = vv_ = rm_ = vm_ = 0.0;
}

}  // namespace hybridtest
