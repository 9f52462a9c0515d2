#include "launch/finish_run.hpp"

#include <fmt/format.h>

#include <iostream>

#include "core/exit_code.hpp"
#include "recording/error.hpp"
#include "recording/run_file.hpp"
#include "recording/run_file_reader.hpp"
#include "recording/summary/run_summary.hpp"

namespace hybridtest {
namespace {

/// A file that cannot be repaired is still read as far as it goes.
void repair_files(const std::filesystem::path& directory) {
  for (const auto& entry : std::filesystem::directory_iterator{directory}) {
    if (entry.path().extension() != kRunFileExtension) continue;
    try {
      static_cast<void>(repair(entry.path()));
    } catch (const RecordingError& error) {
      fmt::print(stderr, "not repaired: {}\n", error.what());
    }
  }
}

}  // namespace

int finish_run(const std::filesystem::path& directory, int exit_code) {
  repair_files(directory);
  try {
    const RunSummary summary = summarise(directory);
    // First to the one who waits: on a full disk there is no room for the file.
    print_summary(summary, std::cout);
    write_summary_json(summary, directory / "summary.json");
    // A coordinator that a signal ended has no say in how the test ended.
    return exit_code == kExitCompleted || exit_code >= 128 ? summary.exit_code : exit_code;
  } catch (const RecordingError& error) {
    fmt::print(stderr, "no summary.json: {}\n", error.what());
    return exit_code == kExitCompleted ? kExitDataInvalid : exit_code;
  }
}

}  // namespace hybridtest
