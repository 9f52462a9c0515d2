#pragma once

#include <compare>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/section.hpp"
#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// A number of a formula, which a model gives and a diagnosis looks for.
struct FormulaNumber {
  std::string name;  // lower-case letters, digits and `_`, a letter first; its unit last: `friction_n`
  double low = -kUnbounded;
  double high = kUnbounded;

  auto operator<=>(const FormulaNumber&) const = default;
};

/// A force of the specimen beside its law that a user writes as a formula: an effect that the library lacks.
struct Formula {
  std::string name;           // of the effect: `heated_damper`
  std::string added_force_n;  // [N], positive when it resists a positive displacement
  std::string input;          // the recorded input beside the motion that it uses by this name; empty: none
  std::vector<FormulaNumber> numbers;

  auto operator<=>(const Formula&) const = default;
};

/// A quantity that a formula may use by its name.
struct FormulaVariable {
  std::string_view name;
  std::string_view what;
};
[[nodiscard]] std::span<const FormulaVariable> formula_variables() noexcept;

/// The type of the effect that adds this force. Numbers whose range is bounded, with respect to which the force is
/// linear and which at zero remove it, are found to be so (EffectParameter::is_linear). The same type for the same
/// formula, for as long as the program runs. Any thread.
/// @throws ConfigError for a name that is taken or no name, for numbers of one name or too many of them, and for a
///         text that is no formula of these numbers, the input and the variables.
[[nodiscard]] const EffectType& formula_effect(const Formula& formula);

/// The same from the keys `name`, `added_force_n`, `input` and the mapping `parameters`. Errors go to the document; the
/// type is then that of no force.
/// @param read_number   reads the value under a key of `parameters`.
[[nodiscard]] const EffectType& read_formula(
    config::Section& section, const std::function<FormulaNumber(config::Section&, const std::string&)>& read_number);

/// The keys of read_formula() as lines without indentation, the numbers of its parameters under `parameters`.
/// @param values   one per parameter of the effect.
[[nodiscard]] std::string written_formula(const Formula& formula, std::span<const double> values);

}  // namespace hybridtest
