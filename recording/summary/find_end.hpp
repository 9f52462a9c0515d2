#pragma once

#include <vector>

#include "recording/run_file.hpp"
#include "recording/summary/run_summary.hpp"

namespace hybridtest {

/// Fills in `stop_reason` (where the coordinator could not record one) and `end` of the summary: who ended the test,
/// why and when. A process that failed by itself is the cause; then the event that belongs to the reason; then what
/// the coordinator recorded.
/// @param events   of all participants, each at least once, in any order.
void find_end(RunSummary& summary, const std::vector<ProcessEnd>& processes, const std::vector<RecordedEvent>& events);

}  // namespace hybridtest
