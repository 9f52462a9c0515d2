#pragma once

#include <cstddef>
#include <cstdio>
#include <mutex>
#include <string_view>

#include "runtime/executor.hpp"

namespace hybridtest {

/// The progress display of a study: on a terminal one line, rewritten in place; otherwise one plain line
/// every few seconds. Any thread may report.
class StudyProgress {
 public:
  /// @param runs   planned. @param out   usually standard error; nullptr: no display.
  StudyProgress(std::size_t runs, std::FILE* out);
  /// Ends the rewritten line.
  ~StudyProgress();
  StudyProgress(const StudyProgress&) = delete;
  StudyProgress& operator=(const StudyProgress&) = delete;

  void completed(std::string_view what);

 private:
  void show(std::string_view what);

  std::size_t runs_;
  std::FILE* out_;
  bool is_terminal_;
  std::mutex mutex_;
  std::size_t completed_ = 0;
  ProcessClock clock_;  // since the study began
  Instant next_show_{};
};

}  // namespace hybridtest
