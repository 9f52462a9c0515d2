#pragma once

#include <filesystem>

namespace hybridtest {

/// Makes files that a killed process left openable, writes `summary.json`, prints the summary.
/// @param exit_code   of the coordinator.
/// @return the exit code of the whole: the coordinator's, or that of the summary when the
///         coordinator saw nothing wrong.
int finish_run(const std::filesystem::path& directory, int exit_code);

}  // namespace hybridtest
