#include "plant/transfer_systems/servo_hydraulic.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/config_error.hpp"
#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {
namespace {

constexpr double kLongestSubstep_rad = 0.1;
constexpr int kSubstepsMax = 1000;

}  // namespace

ServoHydraulic::ServoHydraulic(const Parameters& parameters, Duration control_period)
    : parameters_{checked(parameters)} {
  const Parameters& p = parameters;
  period_s_ = checked("control_period_s", to_seconds(control_period), kPositive);
  const double area_m2 = p.piston_area_m2;
  const double mass_kg = p.moving_mass_kg;
  oil_stiffness_per_m3_ = 4.0 * p.bulk_modulus_pa * area_m2 / p.oil_volume_m3;
  valve_rad_per_s_ = 2.0 * std::numbers::pi * p.valve_frequency_hz;
  const double oil_rad_per_s = std::sqrt((oil_stiffness_per_m3_ * area_m2 + p.load_stiffness_n_per_m) / mass_kg);
  const double leak_per_s = oil_stiffness_per_m3_ / area_m2 * p.leakage_m3_per_s_pa;
  const double valve_per_s = valve_rad_per_s_ * std::max(1.0, 2.0 * p.valve_damping_ratio);
  const double fastest_per_s = std::max({oil_rad_per_s, leak_per_s, valve_per_s, p.damping_n_s_per_m / mass_kg});
  const double substeps = std::ceil(fastest_per_s * period_s_ / kLongestSubstep_rad);
  if (substeps > kSubstepsMax) {
    throw ConfigError{"the actuator has a mode of " + std::to_string(fastest_per_s) +
                      " rad/s, too fast for the control period; expected more moving_mass_kg or oil_volume_m3, or less "
                      "leakage or damping"};
  }
  substeps_ = std::max(1, static_cast<int>(substeps));
  substep_s_ = period_s_ / substeps_;
}

ServoHydraulic::State ServoHydraulic::State::plus(double factor, const State& rate) const noexcept {
  return {.opening = opening + factor * rate.opening,
          .opening_rate_per_s = opening_rate_per_s + factor * rate.opening_rate_per_s,
          .oil_force_n = oil_force_n + factor * rate.oil_force_n,
          .displacement_m = displacement_m + factor * rate.displacement_m,
          .velocity_m_per_s = velocity_m_per_s + factor * rate.velocity_m_per_s,
          .error_integral_m_s = error_integral_m_s + factor * rate.error_integral_m_s};
}

double ServoHydraulic::flow_m3_per_s(const State& state) const noexcept {
  const double opening = std::clamp(state.opening, -1.0, 1.0);
  const double pressure_left = 1.0 - std::copysign(1.0, opening) * state.oil_force_n /
                                         (parameters_.piston_area_m2 * parameters_.supply_pressure_pa);
  // A piston pushed back beyond the supply pressure presses oil into the supply.
  return parameters_.rated_flow_m3_per_s * opening * std::copysign(std::sqrt(std::abs(pressure_left)), pressure_left);
}

ServoHydraulic::State ServoHydraulic::rate(const State& state, const Drive& drive) const noexcept {
  const Parameters& p = parameters_;
  const double error_m = p.command_gain * drive.command_m - state.displacement_m;
  const double error_rate = p.command_gain * drive.command_rate_m_per_s - state.velocity_m_per_s;
  const double asked = p.proportional_gain_per_m * error_m + p.integral_gain_per_m_s * state.error_integral_m_s +
                       p.derivative_gain_s_per_m * error_rate;
  const double opened = std::clamp(asked, -1.0, 1.0);
  const bool winds_up = asked != opened && asked * error_m > 0.0;
  const double load_n = drive.load_force_n + p.load_stiffness_n_per_m * (state.displacement_m - drive.load_from_m);

  State rate;
  rate.opening = state.opening_rate_per_s;
  rate.opening_rate_per_s = valve_rad_per_s_ * (valve_rad_per_s_ * (opened - state.opening) -
                                                2.0 * p.valve_damping_ratio * state.opening_rate_per_s);
  rate.oil_force_n = oil_stiffness_per_m3_ * (flow_m3_per_s(state) - p.piston_area_m2 * state.velocity_m_per_s -
                                              p.leakage_m3_per_s_pa * state.oil_force_n / p.piston_area_m2);
  rate.displacement_m = state.velocity_m_per_s;
  rate.velocity_m_per_s =
      (state.oil_force_n - p.damping_n_s_per_m * state.velocity_m_per_s - load_n) / p.moving_mass_kg;
  rate.error_integral_m_s = winds_up ? 0.0 : error_m;
  return rate;
}

double ServoHydraulic::step_loaded(double command_m, double load_force_n) noexcept {
  Drive drive{.command_m = previous_command_m_,
              .command_rate_m_per_s = (command_m - previous_command_m_) / period_s_,
              .load_force_n = load_force_n,
              .load_from_m = state_.displacement_m};
  for (int i = 0; i < substeps_; ++i) {
    advance(drive);
    drive.command_m += drive.command_rate_m_per_s * substep_s_;
  }
  previous_command_m_ = command_m;
  return state_.displacement_m;
}

void ServoHydraulic::advance(Drive drive) noexcept {
  const double half_s = 0.5 * substep_s_;
  const State k1 = rate(state_, drive);
  drive.command_m += half_s * drive.command_rate_m_per_s;
  const State k2 = rate(state_.plus(half_s, k1), drive);
  const State k3 = rate(state_.plus(half_s, k2), drive);
  drive.command_m += half_s * drive.command_rate_m_per_s;
  const State k4 = rate(state_.plus(substep_s_, k3), drive);
  const State middle = k2.plus(1.0, k3);
  state_ = state_.plus(substep_s_ / 6.0, k1.plus(2.0, middle).plus(1.0, k4));
  stop_at_stroke();
}

/// The piston meets the end of its cylinder and does not bounce.
void ServoHydraulic::stop_at_stroke() noexcept {
  const double stroke_m = parameters_.stroke_m;
  if (std::abs(state_.displacement_m) <= stroke_m) return;
  const double side = std::copysign(1.0, state_.displacement_m);
  state_.displacement_m = side * stroke_m;
  if (side * state_.velocity_m_per_s > 0.0) state_.velocity_m_per_s = 0.0;
}

void ServoHydraulic::reset() noexcept {
  state_ = {};
  previous_command_m_ = 0.0;
}

}  // namespace hybridtest
