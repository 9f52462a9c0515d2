#pragma once

#include <span>

#include "diagnosis/identification/search_table.hpp"
#include "diagnosis/identification/segment.hpp"

namespace hybridtest {

/// Peaks of a recording, which make the search ranges of the effect library fit any specimen.
struct SignalScales {
  double displacement_m = 0.0;
  double velocity_m_per_s = 0.0;
  double acceleration_m_per_s2 = 0.0;
  double force_n = 0.0;  // 0 where no force was measured
  double duration_s = 0.0;

  /// What one unit of a parameter of that scale is, in its own unit; 1 where the recording has no such signal.
  [[nodiscard]] double of(ParameterScale scale) const noexcept;
};

[[nodiscard]] SignalScales scales_of(std::span<const Segment> segments);

}  // namespace hybridtest
