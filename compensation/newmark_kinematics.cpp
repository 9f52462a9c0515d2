#include "compensation/newmark_kinematics.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

NewmarkKinematics::NewmarkKinematics(const Parameters& parameters, double control_period_s)
    : parameters_{checked(parameters)} {
  checked_control_period(control_period_s);
  set_delay(parameters.delay_s);
}

double NewmarkKinematics::command(const CompensatorInput& input) noexcept {
  const double ahead_s = parameters_.step_s + delay_s_;
  return input.target_m +
         ahead_s * (input.target_velocity_m_per_s + 0.5 * ahead_s * input.target_acceleration_m_per_s2);
}

void NewmarkKinematics::set_delay(double delay_s) noexcept {
  if (std::isfinite(delay_s)) delay_s_ = std::clamp(delay_s, 0.0, kDelaySMax);
}

}  // namespace hybridtest
