#pragma once

#include <filesystem>

#include "recording/summary/run_summary.hpp"

namespace hybridtest {

/// Repairs the files of killed processes, prints the summary, writes `summary.json`.
/// @param exit_code   of the coordinator or the simulation; counts when there is no readable file.
/// @return the exit code of the test.
int finish_run(const std::filesystem::path& directory, int exit_code, const SummaryInput& input = {});

}  // namespace hybridtest
