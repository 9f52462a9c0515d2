#pragma once

#include <cstdio>
#include <filesystem>
#include <string>

#include "diagnosis/progress.hpp"
#include "runtime/executor.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// `diagnosis  43 %: effects fitted one by one, 12 of 42 (8310 predictions)`
[[nodiscard]] std::string progress_line(const ProgressReport& report);

/// The display of a running diagnosis: one line, rewritten in place; on a terminal only.
class DiagnosisProgress {
 public:
  /// @param out   usually standard error; standard output is for the result.
  explicit DiagnosisProgress(std::FILE* out);
  /// Ends the line.
  ~DiagnosisProgress();
  DiagnosisProgress(const DiagnosisProgress&) = delete;
  DiagnosisProgress& operator=(const DiagnosisProgress&) = delete;

  /// Of the whole computation; must not outlive the display.
  [[nodiscard]] PartProgress whole();

 private:
  std::FILE* out_;
  std::string shown_;
  ProcessClock clock_;
};

/// For `--diagnose`: diagnose_run() with its progress on standard error and the results on standard output.
void show_diagnosis(const Scenario& scenario, const std::filesystem::path& run);

}  // namespace hybridtest
