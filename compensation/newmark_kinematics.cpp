#include "compensation/newmark_kinematics.hpp"

#include <algorithm>
#include <cmath>

#include "compensation/parameter_check.hpp"

namespace hybridtest {

NewmarkKinematics::NewmarkKinematics(const Parameters& parameters, double control_period_s) : parameters_{parameters} {
  checked_control_period(control_period_s);
  checked_parameter("delay_s", parameters.delay_s, {0.0, kDelaySMax}, "acceleration is not constant for longer");
  checked_parameter("step_s", parameters.step_s, {0.0, 1.0}, "it is the integration step or zero");
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
