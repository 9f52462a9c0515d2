#include "launch/diagnosis_progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <sstream>

#include "diagnosis/runs/diagnose_run.hpp"
#include "runtime/run_directory.hpp"

namespace hybridtest {

std::string progress_line(const ProgressReport& report) {
  const std::string count = report.all > 1 ? fmt::format(", {} of {}", report.done, report.all) : "";
  const std::string moving = report.predictions > 0 ? fmt::format(" ({} predictions)", report.predictions) : "";
  return fmt::format("diagnosis {:3.0f} %: {}{}{}", 100.0 * report.share, report.stage, count, moving);
}

DiagnosisProgress::DiagnosisProgress(std::FILE* out) : out_{out} {}

DiagnosisProgress::~DiagnosisProgress() {
  if (!shown_.empty()) fmt::print(out_, "\n");
}

PartProgress DiagnosisProgress::whole() {
  if (isatty(fileno(out_)) == 0) return {};
  const auto show = [this](const ProgressReport& report) {
    std::string line = progress_line(report);
    if (line == shown_) return;
    fmt::print(out_, "\r{}\033[K", line);
    std::fflush(out_);
    shown_ = std::move(line);
  };
  return PartProgress{show, [this] { return clock_.now(); }};
}

void show_diagnosis(const Scenario& scenario, const std::filesystem::path& run) {
  std::ostringstream results;
  {
    DiagnosisProgress display{stderr};
    diagnose_run(scenario, run, time_utc(), display.whole(), results);
  }
  fmt::print("{}", results.str());
}

}  // namespace hybridtest
