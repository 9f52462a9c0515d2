#pragma once

#include <optional>
#include <string>

namespace hybridtest {

/// What the thread of a control loop requests from the operating system.
struct RealTimeRequest {
  int priority = 80;           // of SCHED_FIFO, 1 to 99
  std::optional<int> cpu;      // the thread stays on it
  bool allow_degraded = true;  // a refusal does not stop the start
};

/// The answers. An error number of 0 means granted.
struct RealTimeGrant {
  int memory_error = 0;                 // mlockall()
  int scheduling_error = 0;             // SCHED_FIFO
  std::optional<int> affinity_error{};  // empty when no cpu was requested

  [[nodiscard]] bool is_complete() const noexcept {
    return memory_error == 0 && scheduling_error == 0 && affinity_error.value_or(0) == 0;
  }
};

/// For the calling thread: touches its stack, locks the memory of the process, schedules the thread
/// before all ordinary threads, and switches off the rounding of its timers. A refused request
/// changes nothing.
[[nodiscard]] RealTimeGrant enter_real_time(const RealTimeRequest& request) noexcept;

/// Threads that the calling thread starts while this lives inherit SCHED_FIFO with this priority, if it is granted:
/// those of a library that cannot be asked. Afterwards the calling thread is scheduled as before.
class InheritedRealTime {
 public:
  explicit InheritedRealTime(int priority) noexcept;
  ~InheritedRealTime();
  InheritedRealTime(const InheritedRealTime&) = delete;
  InheritedRealTime& operator=(const InheritedRealTime&) = delete;

 private:
  int policy_before_ = 0;
  int priority_before_ = 0;
  bool is_changed_ = false;
};

}  // namespace hybridtest
