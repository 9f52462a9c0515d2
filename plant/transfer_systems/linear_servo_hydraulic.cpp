#include "plant/transfer_systems/linear_servo_hydraulic.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

LinearServoHydraulic::LinearServoHydraulic(const Parameters& parameters, Duration control_period)
    : parameters_{checked(parameters)},
      over_period_{discretised(parameters.model, checked("control_period_s", to_seconds(control_period), kPositive))} {}

double LinearServoHydraulic::step(double command_m) noexcept {
  state_ = (over_period_.transition * state_ + over_period_.input * held_command_m_).eval();
  held_command_m_ = converted(command_m);
  return state_[TransferSystemModel::kDisplacement];
}

double LinearServoHydraulic::specimen_force_n() const noexcept {
  constexpr auto kForce = TransferSystemModel::kForce;
  return state_[kForce] * over_period_.scale[kForce];
}

double LinearServoHydraulic::converted(double command_m) const noexcept {
  const double range_m = parameters_.converter_range_m;
  const double step_m = parameters_.converter_step_m;
  const double within_m = range_m > 0.0 ? std::clamp(command_m, -range_m, range_m) : command_m;
  return step_m > 0.0 ? step_m * std::nearbyint(within_m / step_m) : within_m;
}

void LinearServoHydraulic::reset() noexcept {
  state_.setZero();
  held_command_m_ = 0.0;
}

}  // namespace hybridtest
