#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/exit_code.hpp"

namespace hybridtest {

/// Exit code of `ssh` itself: no connection, or no longer, or the key was not accepted.
inline constexpr int kSshFailed = 255;

/// How a process of a test ended, as its parent saw it. A process that was killed cannot record that itself.
struct ProcessEnd {
  std::string participant;
  int exit_code = 0;
  int signal = 0;             // that killed it; 0: it exited by itself
  std::string words;          // the last line of its log
  bool was_asked = false;     // it had been asked to stop, or another process had ended before it
  bool before_start = false;  // of the first step
  std::string host{};         // on which it ran, reached over ssh; empty: on this one

  /// Takes an exit code that ssh handed on: a shell over there tells a signal as 128 + signal.
  void take_code_of_ssh(int code) noexcept;
  /// The connection to the host ended before the process did. What became of the process is not known here; it was told
  /// to stop.
  [[nodiscard]] bool has_lost_connection() const noexcept;

  /// Whether this process failed before anyone asked it to stop. One that left the test in order, completed or ended
  /// early, did not fail.
  [[nodiscard]] bool is_cause() const noexcept {
    const bool left_in_order = exit_code == kExitCompleted || exit_code == kExitEndedEarly;
    return !was_asked && (signal != 0 || !left_in_order);
  }
  /// "killed by signal 9 (Killed)", or its own words.
  [[nodiscard]] std::string text() const;
};

/// `processes.json` of a run directory. The write is best effort: without space it is left out.
void write_process_ends(const std::vector<ProcessEnd>& ends, const std::filesystem::path& run_directory);
/// @return empty when the file is absent or is not one of ours.
[[nodiscard]] std::vector<ProcessEnd> read_process_ends(const std::filesystem::path& run_directory);

}  // namespace hybridtest
