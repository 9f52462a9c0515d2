#pragma once

#include <cstddef>
#include <cstdio>
#include <mutex>
#include <string_view>

#include "runtime/executor.hpp"

namespace hybridtest {

/// What a person sees while a study runs: on a terminal one line that is rewritten, elsewhere a plain line
/// now and then. May be told from any thread.
class StudyProgress {
 public:
  /// @param runs   planned. @param out   standard error, as a rule; nullptr: nobody looks.
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
