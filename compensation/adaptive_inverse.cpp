#include "compensation/adaptive_inverse.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

AdaptiveInverse::AdaptiveInverse(const Parameters& parameters, double control_period_s)
    : parameters_{checked(parameters)}, control_period_s_{checked_control_period(control_period_s)} {}

double AdaptiveInverse::command(const CompensatorInput& input) noexcept {
  if (has_target_) observe(targets_m_[0], input.measured_displacement_m);
  targets_m_.push(input.target_m);
  has_target_ = true;
  return input.target_m + std::max(delay_s(), 0.0) / control_period_s_ * (input.target_m - targets_m_[1]);
}

void AdaptiveInverse::observe(double target_m, double measured_m) noexcept {
  if (!std::isfinite(target_m) || !std::isfinite(measured_m)) return;
  if (has_observed_) {
    indicator_m2_ += 0.25 * ((target_m + observed_target_m_) * (measured_m - observed_displacement_m_) -
                             (measured_m + observed_displacement_m_) * (target_m - observed_target_m_));
    integral_m2_s_ += indicator_m2_ * control_period_s_;
  }
  observed_target_m_ = target_m;
  observed_displacement_m_ = measured_m;
  has_observed_ = true;
  const double wanted_s = control_period_s_ * (parameters_.proportional_gain_per_m2 * indicator_m2_ +
                                               parameters_.integral_gain_per_m2_s * integral_m2_s_);
  correction_s_ = std::clamp(wanted_s, -parameters_.delay_correction_s_max, parameters_.delay_correction_s_max);
}

void AdaptiveInverse::reset() noexcept {
  targets_m_.clear();
  observed_target_m_ = observed_displacement_m_ = 0.0;
  indicator_m2_ = integral_m2_s_ = correction_s_ = 0.0;
  has_observed_ = has_target_ = false;
}

}  // namespace hybridtest
