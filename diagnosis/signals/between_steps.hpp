#pragma once

#include <span>
#include <vector>

namespace hybridtest {

/// The motion behind the readings of a coarse converter. Where a reading changes, the motion passes half way between
/// the two values, whatever the step is; between these instants it is a straight line. Where it turns back, it is the
/// parabola that goes on with the velocity before and after, but at most half a step: there it may be at rest. A
/// reading that changes before and after its sample stays: a motion that passes a step in a sample is read as well as
/// it is known.
///
/// A straight motion is found to half a sample period. Of an acceleration a, where the motion passes with the velocity
/// v, a q^2 / (8 v^2) is left besides: that of a chord over the time q / v.
/// @param readings   one per sample; noise behind the converter is small compared with the step.
/// @param step       q, above 0; steps may be wider or narrower by some percent.
/// @return one value per sample, within a step of its reading.
[[nodiscard]] std::vector<double> between_steps(std::span<const double> readings, double step);

}  // namespace hybridtest
