#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "recording/summary/run_summary.hpp"

namespace hybridtest {

struct ReportRequest {
  std::filesystem::path run;                     // its directory
  std::vector<std::filesystem::path> compare{};  // see read_compared()
  std::string shipped_scenario{};                // effective text of the one of this name; empty without one
};

/// report.html: one page about a run that opens without a network and prints well. Parts whose records are missing are
/// left out with a word. Recordings are read in pieces and thinned while they are read.
/// @param summary   of the run.
/// @throws ConfigError for something to compare with that cannot be read, see run_report::read_compared().
[[nodiscard]] std::string report_page(const ReportRequest& request, const RunSummary& summary);

/// @throws RecordingError when the file cannot be written; as report_page().
void write_report(const ReportRequest& request, const RunSummary& summary, const std::filesystem::path& file);

}  // namespace hybridtest
