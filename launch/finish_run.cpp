#include "launch/finish_run.hpp"

#include <fmt/format.h>

#include <exception>
#include <iostream>

#include "core/exit_code.hpp"
#include "launch/run_report.hpp"
#include "recording/error.hpp"
#include "recording/run_file.hpp"
#include "recording/run_file_reader.hpp"
#include "recording/summary/run_summary.hpp"

namespace hybridtest {
namespace {

/// A file that cannot be repaired is still read up to its last valid row.
void repair_files(const std::filesystem::path& directory) {
  for (const auto& entry : std::filesystem::directory_iterator{directory}) {
    if (entry.path().extension() != kRunFileExtension) continue;
    try {
      static_cast<void>(repair(entry.path()));
    } catch (const RecordingError& error) {
      fmt::print(stderr, "file not repaired: {}\n", error.what());
    }
  }
}

/// The exit code of a test does not depend on its report, so nothing thrown leaves.
void try_report(const std::filesystem::path& directory, const RunSummary& summary) {
  const std::filesystem::path file = report_file(directory);
  try {
    write_run_report(directory, {}, summary, file);
    fmt::print(stderr, "report: {}\n", file.string());
  } catch (const std::exception& error) {
    fmt::print(stderr, "report.html was not written: {}; write it with `hybridtest report {}`\n", error.what(),
               directory.string());
  }
}

}  // namespace

int finish_run(const std::filesystem::path& directory, int exit_code, const SummaryInput& input, ReportWish report) {
  repair_files(directory);
  try {
    const RunSummary summary = summarise(directory, input);
    // Print first: on a full disk the file cannot be written.
    print_summary(summary, std::cout);
    write_summary_json(summary, directory / "summary.json");
    if (report == ReportWish::with) try_report(directory, summary);
    return exit_code == kExitInternal ? exit_code : summary.exit_code;
  } catch (const RecordingError& error) {
    fmt::print(stderr, "summary.json was not written: {}\n", error.what());
    return exit_code == kExitCompleted ? kExitDataInvalid : exit_code;
  }
}

}  // namespace hybridtest
