#pragma once

#include <filesystem>

namespace hybridtest {

/// Repairs the files of killed processes, prints the summary, writes `summary.json`.
/// @param exit_code   of the coordinator.
/// @return the exit code of the test: that of the coordinator, or that of the summary if the coordinator
///         reported no error.
int finish_run(const std::filesystem::path& directory, int exit_code);

}  // namespace hybridtest
