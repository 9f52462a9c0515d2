#pragma once

#include <span>

#include "mechanics/laws/law.hpp"
#include "plant/effects/effect.hpp"

namespace hybridtest {

/// Share of its initial stiffness that a law has lost by the end of a motion, at most 1; 0 where it unloads as stiffly
/// as it began, or never turns. Taken at the last reversal beyond half the largest displacement: the force that the
/// first fiftieth of the range back takes off, per displacement.
/// @param law   is reset, and moved along the motion.
[[nodiscard]] double lost_stiffness(Law& law, std::span<const Motion> motion);

}  // namespace hybridtest
