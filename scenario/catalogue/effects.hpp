#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/config/section.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

/// An effect as listed under `effects`, and whom it concerns.
struct ListedEffect {
  EffectSetting setting;
  std::optional<int> dof;  // from 0; all when absent
};

/// The list under the optional key `effects`.
/// @param interfaces   those an effect may name here.
/// @param dofs         degrees of freedom that it may name with `dof`, counted from 1; 0: it has no such key.
[[nodiscard]] std::vector<ListedEffect> read_effects(config::Section& section,
                                                     const std::vector<EffectInterface>& interfaces, int dofs);

/// Where effects of a simulated site may act.
[[nodiscard]] const std::vector<EffectInterface>& site_interfaces();

/// As an entry of the list `effects` at the top of a file, with a newline at its end.
[[nodiscard]] std::string written_effect(const ListedEffect& effect);

}  // namespace hybridtest
