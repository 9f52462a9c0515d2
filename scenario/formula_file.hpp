#pragma once

#include <filesystem>
#include <vector>

#include "plant/effects/effect_type.hpp"

namespace hybridtest {

/// The formulas of a file that a diagnosis tries beside its library: a list under `formulas`, each as a model's effect
/// `formula`, but its parameters have a range (`from`, `to`) in place of a number.
/// @throws ConfigError with everything that is wrong, for two formulas of one name and for one without a parameter.
[[nodiscard]] std::vector<const EffectType*> read_formulas(const std::filesystem::path& file);

}  // namespace hybridtest
