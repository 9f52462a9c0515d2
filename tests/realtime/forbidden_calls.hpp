#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace hybridtest {

/// Calls that nothing on the control path may make.
struct ForbiddenCalls {
  int allocations = 0;  // malloc and relatives, free included; operator new ends there
  int locks = 0;        // POSIX mutexes, read-write and spin locks, conditions, semaphores
  int writes = 0;       // write, stdio output, syslog
  int clocks = 0;       // reading a clock, sleeping
  bool operator==(const ForbiddenCalls&) const = default;
};

/// False where a sanitizer replaces these functions.
[[nodiscard]] bool can_count_forbidden_calls() noexcept;

/// During its lifetime, forbidden calls of this thread are counted; they still have their effect.
class ForbiddenCallCount {
 public:
  ForbiddenCallCount() noexcept;
  ~ForbiddenCallCount();
  ForbiddenCallCount(const ForbiddenCallCount&) = delete;
  ForbiddenCallCount& operator=(const ForbiddenCallCount&) = delete;

  /// So far, since construction.
  [[nodiscard]] ForbiddenCalls calls() const noexcept;
};

/// Runs `work` in a child process in which the kernel turns every system call away, and returns
/// the numbers of those tried, at most 64; nothing when the kernel cannot do so. Waiting, logging, reading a file and
/// getting memory from the system all end in a system call.
[[nodiscard]] std::optional<std::vector<int>> system_calls_of(void (*work)());

}  // namespace hybridtest
