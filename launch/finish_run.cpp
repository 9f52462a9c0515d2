#include "launch/finish_run.hpp"

#include <fmt/format.h>

#include <iostream>

#include "core/exit_code.hpp"
#include "recording/error.hpp"
#include "recording/run_file.hpp"
#include "recording/run_file_reader.hpp"
#include "recording/summary/run_summary.hpp"

namespace hybridtest {

int finish_run(const std::filesystem::path& directory, int exit_code) {
  for (const auto& entry : std::filesystem::directory_iterator{directory}) {
    if (entry.path().extension() == kRunFileExtension) static_cast<void>(repair(entry.path()));
  }
  try {
    const RunSummary summary = summarise(directory);
    write_summary_json(summary, directory / "summary.json");
    print_summary(summary, std::cout);
    // A coordinator that a signal ended has no say in how the test ended.
    return exit_code == kExitCompleted || exit_code >= 128 ? summary.exit_code : exit_code;
  } catch (const RecordingError& error) {
    fmt::print(stderr, "no summary: {}\n", error.what());
    return exit_code == kExitCompleted ? kExitDataInvalid : exit_code;
  }
}

}  // namespace hybridtest
