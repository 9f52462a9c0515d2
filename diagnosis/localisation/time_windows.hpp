#pragma once

#include <vector>

#include "diagnosis/localisation/gap_signals.hpp"

namespace hybridtest {

/// Energy of the residual over a stretch of time.
struct TimeWindow {
  double begin_s = 0.0;
  double end_s = 0.0;
  double share = 0.0;  // of the residual's energy over the whole recording
  double nrmse = 0.0;  // root mean square of the residual here over that of the output of the whole recording
};

/// Cuts the recording into `count` stretches as equal as samples allow; their shares add up to one
/// unless there is no residual at all.
[[nodiscard]] std::vector<TimeWindow> gap_over_time(const GapSignals& signals, std::size_t count);

/// The fewest of the windows that hold `share` of the energy, neighbours joined, in order of time.
[[nodiscard]] std::vector<TimeWindow> windows_holding(const std::vector<TimeWindow>& windows, double share);

}  // namespace hybridtest
