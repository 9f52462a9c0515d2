// What a long recording costs: 32 signals at 4096 Hz for a quarter of an hour and for an hour of simulated time,
// written by the recorder as a site writes them, in drains of 50 ms, but as fast as the disk is. Prints memory of the
// process that records, bytes per row beside those of its values, the share of real time that writing takes, and for
// every command that reads the run its seconds of the processor, over one bare pass over the same rows, and its memory.
//
// Writes into a folder of the system's for temporary files, at most 4.2 GB for the hour and 11 GB for its CSV files,
// and removes them. Usage: recording_growth [seconds of simulated time]...

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "recording/read_rows.hpp"
#include "recording/run_file.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/process_cost.hpp"

namespace {

using namespace hybridtest;

void read_all(const std::filesystem::path& run) {
  for (const auto& entry : std::filesystem::directory_iterator{run}) {
    if (entry.path().extension() != kRunFileExtension) continue;
    const RunFileReader file{entry.path()};
    for (const TableLayout& table : file.tables()) {
      volatile double sum = 0.0;
      read_rows(file, table.name, [&](std::span<const double> row) {
        sum = sum + row.front();
        return true;
      });
    }
  }
}

void print_commands(const std::filesystem::path& run) {
  const ProcessCost pass = cost_of([&] { read_all(run); });
  std::printf("  %-18s %8.2f s  %6s  %7.1f MB\n", "bare pass", pass.processor_s, "", pass.memory_mb);
  const std::string program = HYBRIDTEST_PROGRAM_DIR "/hybridtest";
  const std::vector<std::vector<std::string>> commands{
      {program, "summary", run}, {program, "report", run}, {program, "export", run, "--csv"}};
  for (const std::vector<std::string>& command : commands) {
    const ProcessCost cost = cost_of_program(command);
    if (cost.exit_code != 0) std::printf("  %s failed with exit code %d\n", command[1].c_str(), cost.exit_code);
    std::printf("  %-18s %8.2f s  %6.1f  %7.1f MB\n", command[1].c_str(), cost.processor_s,
                cost.processor_s / pass.processor_s, cost.memory_mb);
    std::filesystem::remove_all(run / "csv");
  }
}

void measure(const std::filesystem::path& run, double duration_s) {
  const LongRun test{.duration_s = duration_s};
  std::filesystem::create_directory(run);
  const ProcessCost writing = cost_of([&] { test.write(run); });
  const auto bytes = static_cast<double>(std::filesystem::file_size(run / "site.h5"));
  const double bytes_per_row = bytes / static_cast<double>(test.control_rows());
  const double value_bytes = LongRun::kControlColumns * sizeof(double);
  std::printf("%.0f s at %.0f Hz, %zu rows of %d signals and %d more columns\n", duration_s, test.control_rate_hz,
              test.control_rows(), LongRun::kSignals, LongRun::kControlColumns - LongRun::kSignals);
  std::printf("  %-18s %8.2f s  %6s  %7.1f MB, %.1f %% of the time of the test\n", "recording", writing.processor_s, "",
              writing.memory_mb, 100.0 * writing.processor_s / duration_s);
  std::printf("  %-18s %8.1f bytes a row, %.3f of its values\n", "file", bytes_per_row, bytes_per_row / value_bytes);
  print_commands(run);
}

}  // namespace

int main(int count, char** words) {
  std::vector<double> durations_s{900.0, 3600.0};
  if (count > 1) durations_s.clear();
  for (int i = 1; i < count; ++i) durations_s.push_back(std::atof(words[i]));
  std::string pattern = (std::filesystem::temp_directory_path() / "hybridtest_growth_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) return 70;
  std::printf("%-20s %8s    %6s  %7s\n", "", "time", "/ pass", "memory");
  for (const double duration_s : durations_s) {
    const std::filesystem::path run = std::filesystem::path{pattern} / std::to_string(static_cast<int>(duration_s));
    measure(run, duration_s);
    std::filesystem::remove_all(run);
  }
  std::filesystem::remove_all(pattern);
}
