#pragma once

#include <filesystem>
#include <vector>

#include "recording/summary/run_summary.hpp"

namespace hybridtest {

/// `report.html` of a run directory.
[[nodiscard]] std::filesystem::path report_file(const std::filesystem::path& run);

/// The report of a run, beside the shipped scenario of its name.
/// @throws ConfigError, RecordingError as write_report().
void write_run_report(const std::filesystem::path& run, const std::vector<std::filesystem::path>& compare,
                      const RunSummary& summary, const std::filesystem::path& file);

}  // namespace hybridtest
