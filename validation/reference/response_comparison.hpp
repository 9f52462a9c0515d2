#pragma once

#include <filesystem>
#include <string>

#include "recording/summary/reference_comparison.hpp"
#include "validation/reference/monolithic_response.hpp"

namespace hybridtest {

/// The recorded displacements of a run against a reference, at the steps that both have.
/// @param name   of the reference.
/// @throws RecordingError when the run has no such record, or its step is not a multiple of the reference's.
[[nodiscard]] ReferenceComparison compare_run(const std::filesystem::path& run, const Scenario& scenario,
                                              const ReferenceResponse& response, const std::string& name);

/// As a table with a row per step: time_s, displacement_<dof>_m …, for other programs.
/// @throws RecordingError when it cannot be written.
void write_response(const Scenario& scenario, const ReferenceResponse& response, const std::filesystem::path& file);

}  // namespace hybridtest
