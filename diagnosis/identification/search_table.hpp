#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "diagnosis/tuning.hpp"
#include "plant/effects/effect_type.hpp"

namespace hybridtest {

/// The scale of a search range: a friction force is searched in units of the measured force, a clearance in
/// units of the measured displacement.
enum class ParameterScale : std::uint8_t {
  one,             // a ratio or exponent: no scale
  displacement_m,  // peak displacement
  velocity_m_per_s,
  force_n,              // peak force
  stiffness_n_per_m,    // peak force over peak displacement
  damping_n_s_per_m,    // peak force over peak velocity
  mass_kg,              // peak force over peak acceleration
  time_s,               // a second
  duration_s,           // length of the recording
  damping_n_s2_per_m2,  // peak force over the square of the peak velocity
  stiffness_n_per_m3,   // peak force over the cube of the peak displacement
  compliance_m_per_n,   // peak displacement over peak force
  energy_j,             // peak force times peak displacement
  per_m,                // one over the peak displacement
  s_per_m,              // one over the peak velocity
};

/// Beside which law of a specimen a parameter is searched; beside another law it keeps its fallback.
/// with_strength: that some motion reaches; at_strength: that of the recordings does.
enum class LawUse : std::uint8_t { any, spring_or_none, with_strength, at_strength };

/// A limit of the range that the user's model sets.
enum class SearchLimit : std::uint8_t {
  none,
  removable_delay,      // at most the delay of the model's own transfer system is removed
  compensator_setting,  // the compensator's delay stays between zero and its maximum
  own_bandwidth,        // searched where the model's transfer system has one
  within_motion,        // at least a share of the time in which the motion changes
  secant_stiffness,     // of a law that stays a spring, whatever its stiffness: as far as a spring beside it
};

/// Further limits of a range.
struct SearchRestriction {
  LawUse beside = LawUse::any;
  // The value of the real site cannot be negative: the search removes at most the model's own value.
  bool is_amount = false;
  SearchLimit limit = SearchLimit::none;
  // Per unit of the input that the effect follows: over how far that input goes (InputRange::span).
  bool per_input = false;
  // At the upper end it no longer shows in any recording: an estimate there means that it is as large or larger.
  bool is_unseen_at_high = false;
  // The shape of something whose size is found without it: freed from where a search without it ends.
  bool is_freed_last = false;
};

/// The search range of one parameter of one effect.
struct SearchRange {
  EffectInterface interface {};
  std::string_view effect;
  std::string_view parameter;
  ParameterScale scale = ParameterScale::one;
  // In units of `scale` of the recording; cut at what the parameter accepts.
  double low = 0.0;
  double high = 0.0;
  SearchRestriction restriction{};

  /// A time in the recording: it acts in one place only.
  [[nodiscard]] bool is_instant() const noexcept { return scale == ParameterScale::duration_s; }
};

namespace search_table {

using enum EffectInterface;
using Scale = ParameterScale;

/// The strength that goes with a stiffness that degrades.
constexpr SearchRange strength_exponent_of(std::string_view effect) {
  return {specimen, effect, "strength_exponent", Scale::one, 0.0, 1.0, {.beside = LawUse::at_strength}};
}

/// Every parameter that is searched, in the order of the effect library. A parameter without a row keeps its fallback:
/// a seed cannot be found, and the exponent of the Bouc-Wen law is held at 1. Reference and nominal value of an input
/// come from the recordings (left_out()).
///
/// The ranges are chosen: from an effect that is absent, or too small to see, to several times what a test would
/// survive. A limit (stroke, velocity, saturation) ends just above the recorded peak, where it no longer acts.
inline constexpr std::array kRows{
    SearchRange{network, "latency", "latency_s", Scale::time_s, 0.0, 0.2},
    SearchRange{network, "jitter", "jitter_s", Scale::time_s, 0.0, 0.1},
    SearchRange{network, "loss", "loss_ratio", Scale::one, 0.0, 0.5},
    SearchRange{network, "clock_offset", "offset_s", Scale::time_s, 0.0, 0.2},
    SearchRange{network, "clock_drift", "drift_ratio", Scale::one, 0.0, 0.01},
    SearchRange{compensator,
                "setting_mismatch",
                "delay_error_s",
                Scale::time_s,
                -0.1,
                0.1,
                {.limit = SearchLimit::compensator_setting}},
    SearchRange{compensator, "bias", "bias_m", Scale::displacement_m, -0.5, 0.5},
    SearchRange{transfer_system, "delay", "delay_s", Scale::time_s, -0.1, 0.1, {.limit = SearchLimit::removable_delay}},
    SearchRange{transfer_system, "bandwidth", "time_constant_s", Scale::time_s, 0.0, 0.1},
    SearchRange{transfer_system, "bandwidth", "second_order_ratio", Scale::one, 0.0, 2.0},
    SearchRange{transfer_system,
                "bandwidth_error",
                "bandwidth_error_ratio",
                Scale::one,
                -0.8,
                2.0,
                {.limit = SearchLimit::own_bandwidth}},
    SearchRange{transfer_system, "gain", "gain_error", Scale::one, -0.5, 0.5},
    SearchRange{transfer_system, "backlash", "clearance_m", Scale::displacement_m, 0.001, 1.0},
    SearchRange{transfer_system, "deadband", "deadband_m", Scale::displacement_m, 0.001, 0.5},
    SearchRange{transfer_system, "velocity_limit", "velocity_limit_m_per_s", Scale::velocity_m_per_s, 0.02, 1.2},
    SearchRange{transfer_system, "stroke_limit", "stroke_limit_m", Scale::displacement_m, 0.05, 1.1},
    SearchRange{transfer_system, "compliance", "compliance_m_per_n", Scale::compliance_m_per_n, 0.0, 0.5},
    SearchRange{transfer_system, "compliance", "closed_joint_ratio", Scale::one, 0.0, 1.0},
    SearchRange{transfer_system, "compliance", "closing_force_n", Scale::force_n, 0.02, 0.3},
    SearchRange{transfer_system, "stiction", "stick_displacement_m", Scale::displacement_m, 1e-4, 0.5},
    SearchRange{transfer_system, "stiction", "slip_time_s", Scale::time_s, 1e-4, 0.02},
    SearchRange{displacement_sensor, "gain", "gain_error", Scale::one, -0.5, 0.5},
    SearchRange{displacement_sensor, "bias", "bias_m", Scale::displacement_m, -0.5, 0.5},
    SearchRange{displacement_sensor, "drift", "drift_m_per_s", Scale::displacement_m, -0.2, 0.2},
    SearchRange{displacement_sensor, "lag", "time_constant_s", Scale::time_s, 0.0, 1.0},
    SearchRange{displacement_sensor, "lag", "second_order_ratio", Scale::one, 0.0, 1.0},
    SearchRange{displacement_sensor, "quantization", "step_m", Scale::displacement_m, 1e-4, 0.3},
    SearchRange{specimen,
                "stiffness_error",
                "stiffness_error_ratio",
                Scale::one,
                -1.0,
                2.0,
                {.beside = LawUse::with_strength, .limit = SearchLimit::secant_stiffness}},
    SearchRange{specimen,
                "stiffness_error",
                "stiffness_n_per_m",
                Scale::stiffness_n_per_m,
                -2.0,
                2.0,
                {.beside = LawUse::spring_or_none}},
    SearchRange{specimen,
                "strength_error",
                "strength_error_ratio",
                Scale::one,
                -0.9,
                9.0,
                {.beside = LawUse::at_strength, .is_unseen_at_high = true}},
    SearchRange{
        specimen, "hardening_error", "hardening_error_ratio", Scale::one, -0.5, 0.9, {.beside = LawUse::at_strength}},
    SearchRange{specimen, "strength_asymmetry", "shift_m", Scale::displacement_m, -0.3, 0.3},
    SearchRange{
        specimen, "viscous_damping", "damping_n_s_per_m", Scale::damping_n_s_per_m, -2.0, 2.0, {.is_amount = true}},
    SearchRange{specimen,
                "quadratic_damping",
                "damping_n_s2_per_m2",
                Scale::damping_n_s2_per_m2,
                -2.0,
                2.0,
                {.is_amount = true}},
    SearchRange{specimen,
                "nonlinear_viscous_damping",
                "damping_n_s_per_m",
                Scale::damping_n_s_per_m,
                -2.0,
                2.0,
                {.is_amount = true}},
    SearchRange{specimen, "nonlinear_viscous_damping", "exponent", Scale::one, 0.1, 2.0},
    SearchRange{specimen, "nonlinear_viscous_damping", "brace_stretch_m", Scale::displacement_m, 0.0, 1.0},
    SearchRange{specimen, "coulomb_friction", "friction_force_n", Scale::force_n, 0.0, 1.5},
    SearchRange{specimen, "coulomb_friction", "asymmetry", Scale::one, -0.9, 0.9},
    SearchRange{specimen, "coulomb_friction", "presliding_displacement_m", Scale::displacement_m, 1e-4, 0.5},
    SearchRange{specimen, "coulomb_friction", "presliding_exponent", Scale::one, 0.0, 2.0, {.is_freed_last = true}},
    SearchRange{specimen, "stribeck_friction", "friction_force_n", Scale::force_n, 0.0, 1.5},
    SearchRange{specimen, "stribeck_friction", "static_excess_ratio", Scale::one, 0.05, 3.0},
    SearchRange{specimen, "stribeck_friction", "stribeck_velocity_m_per_s", Scale::velocity_m_per_s, 0.01, 0.7},
    SearchRange{specimen, "stribeck_friction", "presliding_displacement_m", Scale::displacement_m, 1e-4, 0.5},
    SearchRange{specimen, "stribeck_friction", "presliding_exponent", Scale::one, 0.0, 2.0, {.is_freed_last = true}},
    SearchRange{specimen, "velocity_strengthening_friction", "friction_force_n", Scale::force_n, 0.0, 1.5},
    SearchRange{specimen, "velocity_strengthening_friction", "slow_friction_ratio", Scale::one, 0.0, 0.95},
    SearchRange{specimen, "velocity_strengthening_friction", "friction_rate_s_per_m", Scale::s_per_m, 1.0, 30.0},
    SearchRange{specimen, "velocity_strengthening_friction", "presliding_displacement_m", Scale::displacement_m, 1e-4,
                0.5},
    SearchRange{specimen, "cubic_stiffness", "stiffness_n_per_m3", Scale::stiffness_n_per_m3, -2.0, 2.0},
    SearchRange{specimen, "yielding", "yield_force_n", Scale::force_n, 0.02, 1.5},
    SearchRange{specimen, "yielding", "stiffness_n_per_m", Scale::stiffness_n_per_m, 0.05, 5.0},
    SearchRange{specimen, "yielding", "r0", Scale::one, 1.5, 25.0},
    SearchRange{specimen, "bouc_wen_hysteresis", "yield_force_n", Scale::force_n, 0.0, 2.0},
    SearchRange{specimen, "bouc_wen_hysteresis", "yield_displacement_m", Scale::displacement_m, 0.03, 1.0},
    SearchRange{specimen, "bouc_wen_hysteresis", "dissipation_share", Scale::one, 0.2, 1.0},
    SearchRange{specimen, "pinching", "pinching_ratio", Scale::one, 0.0, 1.0},
    SearchRange{specimen, "pinching", "pinching_width_m", Scale::displacement_m, 0.02, 2.0},
    SearchRange{specimen, "stiffness_degradation", "half_life_m", Scale::displacement_m, 3.0, 3000.0},
    strength_exponent_of("stiffness_degradation"),
    SearchRange{specimen, "stiffness_degradation_with_peak", "half_life_m", Scale::displacement_m, 0.1, 300.0},
    strength_exponent_of("stiffness_degradation_with_peak"),
    SearchRange{specimen, "stiffness_degradation_with_energy", "half_life_j", Scale::energy_j, 0.3, 3000.0},
    strength_exponent_of("stiffness_degradation_with_energy"),
    SearchRange{specimen, "stiffness_degradation_with_cycles", "half_life_cycles", Scale::one, 0.5, 3000.0},
    strength_exponent_of("stiffness_degradation_with_cycles"),
    SearchRange{specimen, "stiffness_degradation_with_time", "half_life_s", Scale::time_s, 0.3, 30000.0},
    strength_exponent_of("stiffness_degradation_with_time"),
    SearchRange{specimen, "strength_degradation", "path_m", Scale::displacement_m, 3.0, 3000.0},
    SearchRange{specimen, "strength_degradation_with_peak", "decay_m", Scale::displacement_m, 0.1, 300.0},
    SearchRange{specimen, "strength_degradation_with_energy", "decay_j", Scale::energy_j, 0.3, 3000.0},
    SearchRange{specimen, "strength_degradation_with_cycles", "decay_cycles", Scale::one, 0.5, 3000.0},
    SearchRange{specimen, "strength_degradation_with_time", "decay_s", Scale::time_s, 0.3, 30000.0},
    SearchRange{specimen, "gap", "gap_m", Scale::displacement_m, 0.001, 0.95},
    SearchRange{specimen, "backlash", "clearance_m", Scale::displacement_m, 0.005, 1.0},
    SearchRange{specimen, "backlash", "holding_ratio", Scale::one, 0.0, 1.0},
    SearchRange{specimen, "contact", "stiffness_n_per_m", Scale::stiffness_n_per_m, 0.0, 50.0},
    SearchRange{specimen, "contact", "position_m", Scale::displacement_m, -0.95, 0.95},
    SearchRange{specimen, "contact", "other_stiffness_ratio", Scale::one, 0.0, 2.0},
    SearchRange{specimen, "contact", "other_position_ratio", Scale::one, 0.3, 2.0, {.is_freed_last = true}},
    SearchRange{specimen, "relaxation", "stiffness_n_per_m", Scale::stiffness_n_per_m, 0.0, 3.0},
    SearchRange{
        specimen, "relaxation", "time_constant_s", Scale::time_s, 0.005, 100.0, {.limit = SearchLimit::within_motion}},
    SearchRange{specimen, "fractional_damping", "stiffness_n_per_m", Scale::stiffness_n_per_m, 0.0, 3.0},
    SearchRange{specimen, "fractional_damping", "order", Scale::one, 0.1, 0.9},
    SearchRange{specimen, "inertia", "mass_kg", Scale::mass_kg, -2.0, 2.0, {.is_amount = true}},
    SearchRange{specimen, "geometric_stiffness", "axial_force_n", Scale::force_n, -30.0, 30.0},
    SearchRange{specimen,
                "geometric_stiffness",
                "height_m",
                Scale::displacement_m,
                tuning::kHeightOverStroke,
                30.0,
                {.is_unseen_at_high = true}},
    SearchRange{specimen, "fracture", "lost_ratio", Scale::one, 0.0, 1.0},
    SearchRange{specimen, "fracture", "instant_s", Scale::duration_s, 0.02, 0.98},
    SearchRange{specimen, "force_with_input", "force_ratio_per_unit", Scale::one, -2.0, 2.0, {.per_input = true}},
    SearchRange{
        specimen, "friction_with_input", "friction_force_n_per_unit", Scale::force_n, -1.5, 1.5, {.per_input = true}},
    SearchRange{specimen, "friction_with_input", "presliding_displacement_m", Scale::displacement_m, 1e-4, 0.5},
    SearchRange{specimen,
                "damping_with_input",
                "damping_n_s_per_m_per_unit",
                Scale::damping_n_s_per_m,
                -2.0,
                2.0,
                {.per_input = true}},
    SearchRange{force_sensor, "gain", "gain_error", Scale::one, -0.5, 0.5},
    SearchRange{force_sensor, "bias", "bias_n", Scale::force_n, -0.5, 0.5},
    SearchRange{force_sensor, "drift", "drift_n_per_s", Scale::force_n, -0.2, 0.2},
    SearchRange{force_sensor, "lag", "time_constant_s", Scale::time_s, 0.0, 1.0},
    SearchRange{force_sensor, "lag", "second_order_ratio", Scale::one, 0.0, 1.0},
    SearchRange{force_sensor, "saturation", "limit_n", Scale::force_n, 0.3, 1.1},
    SearchRange{force_sensor, "quantization", "step_n", Scale::force_n, 1e-4, 0.3},
    SearchRange{force_sensor, "time_skew", "skew_s", Scale::time_s, 0.0, 1.0},
    SearchRange{numerical_substructure, "mass_error", "mass_error_ratio", Scale::one, -0.5, 0.5},
    SearchRange{numerical_substructure, "stiffness_error", "stiffness_error_ratio", Scale::one, -0.5, 0.5},
    SearchRange{numerical_substructure, "damping_error", "damping_error_ratio", Scale::one, -1.0, 4.0},
    SearchRange{numerical_substructure, "step_mismatch", "step_error_ratio", Scale::one, -0.5, 0.5},
};

}  // namespace search_table

/// The row of a parameter; nullptr: it is not searched.
[[nodiscard]] constexpr const SearchRange* search_range(const EffectType& effect, const EffectParameter& parameter) {
  const auto& rows = search_table::kRows;
  const auto row = std::ranges::find_if(rows, [&](const SearchRange& range) {
    return range.interface == effect.interface && range.effect == effect.name && range.parameter == parameter.name;
  });
  return row == rows.end() ? nullptr : &*row;
}

}  // namespace hybridtest
