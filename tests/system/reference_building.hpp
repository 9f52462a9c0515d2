#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/recorded_run.hpp"

namespace hybridtest {

/// Displacements of both floors as OpenSees computed them, at 0.01 s, 0.02 s …
struct ReferenceHistory {
  std::vector<double> floor_1_m;
  std::vector<double> floor_2_m;
};

/// @return nothing in it where the recorded data are absent.
[[nodiscard]] ReferenceHistory read_reference(const std::string& law);
/// The record that the reference building was shaken with; may be absent.
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
