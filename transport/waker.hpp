#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

namespace hybridtest {

/// The thread of a participant waits on it between two runs of its Node.
///
/// Every inbox of the participant signals it when something arrives; so may any other thread
/// (Ctrl-C, a control loop with a fault). A signal without a waiting thread is remembered;
/// several are remembered as one. signal() without a waiting thread and a wait with a signal
/// pending make no system call.
class Waker {
 public:
  Waker() = default;
  Waker(const Waker&) = delete;
  Waker& operator=(const Waker&) = delete;

  /// Any thread, also from a signal handler.
  void signal() noexcept;

  /// One thread only. Uses up the signal.
  /// @param deadline   absolute; time_point::max() waits for a signal alone.
  /// @return true when signalled, false when the deadline passed first.
  [[nodiscard]] bool wait_until(std::chrono::steady_clock::time_point deadline) noexcept;

 private:
  std::atomic<std::uint32_t> state_{0};
};

}  // namespace hybridtest
