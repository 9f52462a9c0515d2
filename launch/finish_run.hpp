#pragma once

#include <filesystem>

#include "recording/summary/run_summary.hpp"

namespace hybridtest {

/// Whether a finished run gets its `report.html`.
enum class ReportWish { without, with };

/// Repairs the files of killed processes, prints the summary, writes `summary.json` and, if wished, `report.html`. A
/// report that cannot be written is said on standard error and changes nothing else.
/// @param exit_code   of the coordinator or the simulation; counts when there is no readable file.
/// @return the exit code of the test.
int finish_run(const std::filesystem::path& directory, int exit_code, const SummaryInput& input = {},
               ReportWish report = ReportWish::without);

}  // namespace hybridtest
