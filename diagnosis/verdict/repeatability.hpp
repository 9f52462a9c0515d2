#pragma once

#include <span>
#include <vector>

#include "diagnosis/identification/segment.hpp"
#include "diagnosis/result/diagnosis_report.hpp"

namespace hybridtest {

/// How closely the residual of each judged interface comes back, where the test repeats itself: recordings with the
/// same input, else cycles (floor_of_repetition(), floor_of_cycles()); the largest of an interface. It holds what noise
/// alone does not: what the specimen and the actuator do differently from one time to the next.
void add_repeatability(const SiteModel& model, std::span<const Segment> segments,
                       std::vector<report::InterfaceGap>& where);

}  // namespace hybridtest
