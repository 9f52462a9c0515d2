#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string_view>

#include "plant/effects/effect.hpp"

namespace hybridtest {

/// Where along the chain of a hybrid test an effect acts.
enum class EffectInterface : std::uint8_t {
  network,
  compensator,
  transfer_system,
  displacement_sensor,
  specimen,
  force_sensor,
  numerical_substructure,
};

/// As written in scenarios and diagnoses: `transfer_system`.
[[nodiscard]] std::string_view name_of(EffectInterface interface) noexcept;

/// What one unit of a parameter is measured in, so that a search can scale it by a recording: a
/// friction force by the measured force, a clearance by the measured displacement.
enum class ParameterScale : std::uint8_t {
  one,             // a ratio or exponent: no scale
  displacement_m,  // peak displacement
  velocity_m_per_s,
  force_n,            // peak force
  stiffness_n_per_m,  // peak force over peak displacement
  damping_n_s_per_m,  // peak force over peak velocity
  mass_kg,            // peak force over peak acceleration
  time_s,             // a second
  duration_s,         // length of the recording
  frequency_hz,
  damping_n_s2_per_m2,  // peak force over the square of the peak velocity
  stiffness_n_per_m3,   // peak force over the cube of the peak displacement
  compliance_m_per_n,   // peak displacement over peak force
};

/// Beside which law of a specimen a search looks for a parameter; beside another one it has its fallback.
enum class LawUse : std::uint8_t { any, spring_or_none, with_strength };

struct EffectParameter {
  std::string_view name;  // its unit last: `friction_force_n`
  std::string_view unit;  // "N"; "" for a ratio
  std::string_view what;  // in half a line
  // What is accepted in a scenario, both ends included.
  double low = 0.0;
  double high = 0.0;
  // Where a search looks, in units of `scale` of the recording; within low and high. Both the
  // same: nothing to search, the fallback is used.
  ParameterScale scale = ParameterScale::one;
  double search_low = 0.0;
  double search_high = 0.0;
  // The value at which the effect is absent; NaN when no value of this parameter alone removes it.
  double neutral = 0.0;
  // The change of the stage's output is proportional to it, the others held (variable projection).
  bool is_linear = false;
  // What a scenario that leaves it out gets; NaN when it has to be given.
  double fallback = std::numeric_limits<double>::quiet_NaN();
  LawUse needs = LawUse::any;
  // A real site has no less than none of it: a search takes off at most what the model has.
  bool is_amount = false;
};

/// One entry of the effect library: what a scenario, the simulated rig, the diagnosis and an
/// augmented model share of an effect.
struct EffectType {
  EffectInterface interface {};
  std::string_view name;      // `coulomb_friction`
  std::string_view equation;  // one line
  std::string_view source;    // paper or textbook
  std::span<const EffectParameter> parameters;
  /// @param values   one per parameter, in their order, within [low, high].
  /// null for what changes the coordinator's own model.
  std::unique_ptr<Effect> (*make)(std::span<const double> values, double sample_period_s) = nullptr;
  /// For a sensor: an effect whose before() makes the true motion of a read one, to drive a specimen
  /// by what was measured; null where that is not possible (quantization) or has no meaning.
  std::unique_ptr<Effect> (*make_inverse)(std::span<const double> values, double sample_period_s) = nullptr;
};

/// Every effect there is, in the order of the interfaces.
[[nodiscard]] std::span<const EffectType> effect_library() noexcept;

/// nullptr when there is none of that name.
[[nodiscard]] const EffectType* find_effect(EffectInterface interface, std::string_view name) noexcept;

}  // namespace hybridtest
