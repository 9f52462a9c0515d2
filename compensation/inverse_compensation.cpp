#include "compensation/inverse_compensation.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

InverseCompensation::InverseCompensation(const Parameters& parameters, double control_period_s)
    : initial_delay_s_{checked(parameters).delay_s},
      control_period_s_{checked_control_period(control_period_s)},
      targets_m_{2} {
  set_delay(initial_delay_s_);
}

double InverseCompensation::command(const CompensatorInput& input) noexcept {
  targets_m_.push(input.target_m);
  return input.target_m + delay_s_ / control_period_s_ * (input.target_m - targets_m_[1]);
}

void InverseCompensation::reset() noexcept {
  targets_m_.clear();
  set_delay(initial_delay_s_);
}

void InverseCompensation::set_delay(double delay_s) noexcept {
  if (std::isfinite(delay_s)) delay_s_ = std::clamp(delay_s, 0.0, kDelaySMax);
}

}  // namespace hybridtest
