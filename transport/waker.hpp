#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

namespace hybridtest {

/// What the thread that waits on a Waker does itself meanwhile: it receives. So a message wakes one thread, and not a
/// thread of the network layer that wakes another.
class Reception {
 public:
  virtual ~Reception() = default;

  /// Passes on what has arrived. Never waits for the network.
  virtual void receive() noexcept = 0;
  /// Returns when something has arrived, after interrupt(), or at the deadline; at times earlier.
  /// @param deadline   absolute; time_point::max() has none.
  /// @return false when the deadline passed.
  [[nodiscard]] virtual bool await(std::chrono::steady_clock::time_point deadline) noexcept = 0;
  /// Ends an await() of now or the next one. Any thread, also from a signal handler.
  virtual void interrupt() noexcept = 0;
};

/// The thread of a participant waits on it between two runs of its Node.
///
/// Every inbox of the participant signals it when something arrives; so may any other thread
/// (Ctrl-C, a control loop with a fault). A signal without a waiting thread is remembered;
/// several are remembered as one. signal() without a waiting thread makes no system call, nor does a wait with a signal
/// pending on a waker without a Reception.
class Waker {
 public:
  /// @param reception   is what a wait does; without one it sleeps. Outlives the waker.
  explicit Waker(Reception* reception = nullptr) noexcept : reception_{reception} {}
  Waker(const Waker&) = delete;
  Waker& operator=(const Waker&) = delete;

  /// Any thread, also from a signal handler.
  void signal() noexcept;

  /// One thread only. Uses up the signal. Also with a deadline in the past it receives what has arrived.
  /// @param deadline   absolute; time_point::max() waits for a signal alone.
  /// @return true when signalled, false when the deadline passed first.
  [[nodiscard]] bool wait_until(std::chrono::steady_clock::time_point deadline) noexcept;

 private:
  std::atomic<std::uint32_t> state_{0};
  Reception* reception_;
};

}  // namespace hybridtest
