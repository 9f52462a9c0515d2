#pragma once

#include <string>
#include <vector>

#include "plant/effects/effect_type.hpp"

namespace hybridtest {

/// The test that would tell these effects apart; empty for fewer than two.
[[nodiscard]] std::string experiment_that_splits(const std::vector<const EffectType*>& effects);

/// The test to run where a gap is repeatable and no effect of the library explains it.
[[nodiscard]] std::string experiment_for_unknown(EffectInterface interface);

}  // namespace hybridtest
