// Time and memory of the report of a run of 31 s, of 310 s and of an hour at 1 kHz with two sites, beside one bare pass
// over the same rows, measured in one run. The page itself and, as `hybridtest report` has to, the summary before it;
// each in a process of its own, whose processor time and longest memory the system counts.
//
// The runs are simulated into a folder of the system's for temporary files, about 3 GB, and removed.

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>

#include "recording/read_rows.hpp"
#include "recording/run_file_reader.hpp"
#include "report/run_report/run_report.hpp"

namespace {

using namespace hybridtest;

struct Cost {
  double processor_s = 0.0;
  double memory_mb = 0.0;  // longest
};

/// Of some work in a process of its own.
Cost cost_of(const std::function<void()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    work();
    _exit(0);
  }
  int status = 0;
  rusage used{};
  if (wait4(child, &status, 0, &used) != child || status != 0) {
    std::fprintf(stderr, "the work failed\n");
    std::exit(70);
  }
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return {seconds(used.ru_utime) + seconds(used.ru_stime), 1e-3 * static_cast<double>(used.ru_maxrss)};
}

void simulate_into(const std::filesystem::path& run, int duration_s) {
  std::string command{HYBRIDTEST_PROGRAM_DIR
                      "/hybridtest simulate " HYBRIDTEST_SOURCE_DIR
                      "/launch/scenarios/two_storey_two_sites.yaml --seed 1 --no-report --set time.duration_s="};
  command.append(std::to_string(duration_s)).append(" --out ").append(run.string()).append(" >/dev/null 2>&1");
  if (std::system(command.c_str()) != 0) {
    std::fprintf(stderr, "%s: failed\n", command.c_str());
    std::exit(70);
  }
}

void read_all(const std::filesystem::path& run) {
  for (const auto& entry : std::filesystem::directory_iterator{run}) {
    if (entry.path().extension() != kRunFileExtension) continue;
    const RunFileReader file{entry.path()};
    for (const TableLayout& table : file.tables()) {
      double sum = 0.0;
      read_rows(file, table.name, [&](std::span<const double> row) {
        sum += row.front();
        return true;
      });
    }
  }
}

}  // namespace

int main() {
  std::string pattern = (std::filesystem::temp_directory_path() / "hybridtest_report_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) return 70;
  const std::filesystem::path folder = pattern;
  std::printf("%8s  %10s  %10s  %10s  %12s  %12s  %14s\n", "model s", "rows read", "page s", "report s", "page / rows",
              "page MB", "with summary MB");
  for (const int duration_s : {31, 310, 3600}) {
    const std::filesystem::path run = folder / std::to_string(duration_s);
    simulate_into(run, duration_s);
    const Cost rows = cost_of([&] { read_all(run); });
    // The page does not need the figures of the summary to be drawn.
    const Cost page = cost_of([&] { write_report({.run = run}, RunSummary{}, run / "report.html"); });
    const Cost whole = cost_of([&] { write_report({.run = run}, summarise(run), run / "report.html"); });
    std::printf("%8d  %8.2f s  %8.2f s  %8.2f s  %12.1f  %12.0f  %14.0f\n", duration_s, rows.processor_s,
                page.processor_s, whole.processor_s, page.processor_s / rows.processor_s, page.memory_mb,
                whole.memory_mb);
    std::filesystem::remove_all(run);
  }
  std::filesystem::remove_all(folder);
}
