#pragma once

#include <optional>
#include <string>

namespace hybridtest {

/// What a control loop's thread asks of the operating system.
struct RealTimeRequest {
  int priority = 80;           // of SCHED_FIFO, 1 to 99
  std::optional<int> cpu;      // to stay on
  bool allow_degraded = true;  // a refusal does not stop the start
};

/// What it got. An error number of 0 is a yes.
struct RealTimeGrant {
  int memory_error = 0;                 // mlockall()
  int scheduling_error = 0;             // SCHED_FIFO
  std::optional<int> affinity_error{};  // nothing when no cpu was asked for

  [[nodiscard]] bool is_complete() const noexcept {
    return memory_error == 0 && scheduling_error == 0 && affinity_error.value_or(0) == 0;
  }
};

/// For the calling thread: its stack is touched, what the process has in memory stays there, it is
/// scheduled before all ordinary threads, and its timers are not rounded. What is refused is left
/// as it was.
[[nodiscard]] RealTimeGrant enter_real_time(const RealTimeRequest& request) noexcept;

}  // namespace hybridtest
