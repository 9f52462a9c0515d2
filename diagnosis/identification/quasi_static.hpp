#pragma once

#include <span>
#include <vector>

#include "diagnosis/identification/segment.hpp"
#include "diagnosis/recording.hpp"

namespace hybridtest {

/// The specimen's segment of a quasi-static recording, if displacement and force were recorded; the actuator and the
/// network, whose errors are of time, have none.
///
/// Displacements are taken as recorded: the points of such a test are coarse, and smoothing over them would cut the
/// reversals off. The velocity has the sign of the last change of displacement and is otherwise as small as a number
/// can be, so that a law sees the direction of the motion and no rate. The acceleration is zero.
[[nodiscard]] std::vector<Segment> quasi_static_segments(const Recording& recording, const DofRecording& dof,
                                                         std::size_t position);

/// Standard deviation of the noise of `force_n`, noise of the displacement seen in it included, over all four
/// successive points of one direction of motion: what a parabola over displacement through them leaves, which is their
/// third divided difference over the one of white noise of deviation 1. The median of them, so that yielding and
/// cracking do not count; an upper limit where points are coarse. 0 without such points.
[[nodiscard]] double noise_along_path(std::span<const double> displacement_m, std::span<const double> force_n);

}  // namespace hybridtest
