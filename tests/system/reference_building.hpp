#pragma once

#include <filesystem>
#include <string>

#include "tests/support/recorded_run.hpp"
#include "tests/support/reference_history.hpp"

namespace hybridtest {

/// Recorded data, which may be absent: the two-storey building under El Centro, and that motion.
[[nodiscard]] std::filesystem::path recorded_reference(const std::string& law);
[[nodiscard]] std::filesystem::path reference_motion();

/// Largest distance of a run from the reference, of each floor, as a share of that floor's peak.
struct ReferenceDistance {
  double floor_1 = 0.0;
  double floor_2 = 0.0;
  std::size_t samples = 0;
};
/// @param run   with a step of 0.001 s.
[[nodiscard]] ReferenceDistance distance_from(const ReferenceHistory& reference, const RecordedRun& run);

}  // namespace hybridtest
