#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mechanics/laws/law.hpp"
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

/// What an effect follows, and with it which experiment separates it from others.
enum class EffectFamily : std::uint8_t {
  amplitude,    // how far the motion goes, and back
  rate,         // how fast it goes
  arrival,      // when targets reach the site
  position,     // where along the stroke it is
  scale,        // proportional to what it changes
  offset,       // a zero that is wrong or wanders
  load,         // the force of the specimen
  mass,         // acceleration
  degradation,  // what the specimen went through before
};

/// A number of the user's model that an effect corrects; every model has such numbers slightly wrong.
enum class ModelNumber : std::uint8_t {
  none,
  mass,
  stiffness,
  strength,
  hardening,
  damping,
  step,
  gain,
  delay,
  bandwidth,
  offset
};

/// What of an effect shows in the digits of a recording, where no prediction follows it sample by sample.
enum class DigitTrace : std::uint8_t { none, rounding, lateness, loss };

/// What a diagnosis has to know of an effect beside its parameters.
struct EffectTraits {
  EffectFamily family = EffectFamily::amplitude;
  ModelNumber number = ModelNumber::none;
  DigitTrace digits = DigitTrace::none;
  bool follows_derivatives = false;  // its force follows velocity or acceleration
  bool follows_stiffness = false;    // it has to know the initial stiffness of the specimen's law
  bool needs_time = false;           // it follows rate, time or acceleration: without time it has no meaning
  bool takes_place = false;          // beside one that the model has, it takes its place; see add_effect()
  bool takes_input = false;          // it follows a recorded input beside the motion; see with_input()
  bool bends_curve = false;          // its force follows the displacement along a curve, the same way back
};

struct EffectParameter {
  std::string_view name;  // its unit last: `friction_force_n`
  std::string_view unit;  // "N"; "" for a ratio
  std::string_view what;  // in half a line
  // What is accepted in a scenario, both ends included.
  double low = 0.0;
  double high = 0.0;
  // The value at which the effect is absent; NaN when no value of this parameter alone removes it.
  double neutral = 0.0;
  // The change of the stage's output is proportional to it, the others held (variable projection).
  bool is_linear = false;
  // What a scenario that leaves it out gets; NaN when it has to be given.
  double fallback = std::numeric_limits<double>::quiet_NaN();
};

/// A parameter of a law as a scenario writes it.
struct LawParameter {
  std::string name;  // its unit last: `yield_force_n`
  double value = 0.0;
};

/// A law that takes the place of the specimen's own: not an effect beside the law, but a law of another form.
struct LawReplacement {
  std::string_view law;       // its `type` in a scenario: `bouc_wen`
  std::string_view in_words;  // what a specimen of this law does: `pinches`
  /// @param values   one per parameter of the effect.
  /// @return null where they leave no force.
  std::unique_ptr<Law> (*make)(std::span<const double> values) = nullptr;
  /// The same as the law's own parameters, in the order of a scenario.
  std::vector<LawParameter> (*written)(std::span<const double> values) = nullptr;
};

struct Formula;

/// One entry of the effect library: what a scenario, the simulated rig, the diagnosis and an
/// augmented model share of an effect.
struct EffectType {
  EffectInterface interface {};
  std::string_view name;      // `coulomb_friction`
  std::string_view equation;  // one line
  std::string_view source;    // paper or textbook
  EffectTraits traits;
  std::span<const EffectParameter> parameters;
  /// @param values   one per parameter, in their order, within [low, high].
  /// null for what changes the coordinator's own model.
  std::function<std::unique_ptr<Effect>(std::span<const double> values, double sample_period_s)> make{};
  /// For a sensor: an effect whose before() makes the true motion of a read one, to drive a specimen
  /// by what was measured; null where that is not possible (quantization) or has no meaning.
  std::unique_ptr<Effect> (*make_inverse)(std::span<const double> values, double sample_period_s) = nullptr;
  /// Set for a law in place of the specimen's own; it has no make(). The effect library has none of these.
  const LawReplacement* replacement = nullptr;
  /// The recorded input that it follows, `current_a`; empty in the library, and of effects that follow none.
  std::string_view input{};
  /// Set for a force that a user wrote as a formula; the effect library has none of these.
  const Formula* formula = nullptr;
};

/// Every effect there is, in the order of the interfaces.
[[nodiscard]] std::span<const EffectType> effect_library() noexcept;

/// nullptr when there is none of that name.
[[nodiscard]] const EffectType* find_effect(EffectInterface interface, std::string_view name) noexcept;
/// The effect that corrects that number of the model, or leaves that trace; nullptr when there is none.
[[nodiscard]] const EffectType* find_effect(EffectInterface interface, ModelNumber number) noexcept;
[[nodiscard]] const EffectType* find_effect(EffectInterface interface, DigitTrace digits) noexcept;

/// An effect of the library that takes an input, following the input of that name: a type of its own, so that two
/// inputs are two effects. The same one for the same names, for as long as the program runs. Any thread.
[[nodiscard]] const EffectType& with_input(const EffectType& type, std::string_view input);

/// Whether an input may have this name: lower-case letters, digits and `_`, a letter first.
[[nodiscard]] bool is_input_name(std::string_view name) noexcept;

}  // namespace hybridtest
