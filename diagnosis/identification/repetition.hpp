#pragma once

#include <span>
#include <vector>

#include "diagnosis/identification/problem.hpp"
#include "diagnosis/signals/signals.hpp"

namespace hybridtest {

/// Whether one of two segments may repeat the other: the same channels of specimens that have gone through nothing
/// before, and the same recorded inputs beside the motion.
[[nodiscard]] bool may_repeat(const Segment& first, const Segment& second);

/// Per segment, the difference between its residual and that of a segment which repeats its motion, over the square
/// root of two [rms]: what no model can reproduce, noise among it. 0: no segment repeats it.
/// @param signals   one per segment.
[[nodiscard]] std::vector<double> repetition_floors(std::span<const FitSegment> segments,
                                                    std::span<const GapSignals> signals);

}  // namespace hybridtest
