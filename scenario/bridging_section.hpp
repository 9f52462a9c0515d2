#pragma once

#include "coordinator/force_bridge.hpp"
#include "core/config/section.hpp"

namespace hybridtest {

/// Reads `bridging` of a test in real time. Without it: a straight line through the last two forces, a deadline after
/// half a step, at most three in a row.
[[nodiscard]] BridgingSettings read_bridging(config::Section& root, double step_s);

}  // namespace hybridtest
