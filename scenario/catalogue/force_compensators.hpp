#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "compensation/force_compensator.hpp"
#include "scenario/catalogue/part.hpp"

namespace hybridtest {

using ForceCompensatorMaker = std::function<std::unique_ptr<ForceCompensator>(double control_period_s)>;

/// Every compensator on forces that a file can name.
[[nodiscard]] const std::vector<PartType<ForceCompensatorMaker>>& force_compensators();

/// `none` when no type is given.
[[nodiscard]] ForceCompensatorMaker read_force_compensator(config::Section section);

}  // namespace hybridtest
