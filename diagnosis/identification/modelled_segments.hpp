#pragma once

#include <vector>

#include "diagnosis/identification/segment.hpp"

namespace hybridtest {

/// The segments of one degree of freedom that a model says something of, along the chain. Where it says that the force
/// follows velocity or acceleration, which no displacement sensor measures well, force and motion are smoothed alike
/// (smoothed_alike()), as far as brings the prediction nearest to the force as recorded: less drowns the derivatives in
/// noise, more takes their peaks.
[[nodiscard]] std::vector<Segment> modelled_segments(const SiteModel& model, const Recording& recording,
                                                     std::size_t dof, std::size_t position);

}  // namespace hybridtest
