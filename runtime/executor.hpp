#pragma once

#include <chrono>
#include <functional>
#include <optional>

#include "core/node.hpp"
#include "core/time.hpp"
#include "transport/waker.hpp"

namespace hybridtest {

/// The clock of one process: instants since it was made, from the steady clock.
class ProcessClock {
 public:
  ProcessClock() noexcept : start_{std::chrono::steady_clock::now()} {}

  [[nodiscard]] Instant now() const noexcept {
    return Instant{std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now() - start_)};
  }
  /// As a deadline for waiting; kNever is never.
  [[nodiscard]] std::chrono::steady_clock::time_point deadline(Instant instant) const noexcept {
    if (instant == kNever) return std::chrono::steady_clock::time_point::max();
    return start_ + instant.time_since_epoch();
  }

 private:
  std::chrono::steady_clock::time_point start_;
};

/// Runs a Node on the calling thread until `is_done`: advances it whenever it wants to run or
/// something arrived, sleeps on absolute deadlines in between.
///
/// `between` is called after each advance(), for what a Node may not do itself: stop requests,
/// logging, recording failures.
void run_until(Node& node, Waker& waker, const ProcessClock& clock, const std::function<bool()>& is_done,
               const std::function<void(Instant)>& between);

/// Sleeps until then, whatever signals come. No lock, no allocation.
void rest_until(const ProcessClock& clock, Instant instant) noexcept;

/// Sleeps, a millisecond at a time, while the condition holds.
void wait_while(const std::function<bool()>& condition);

/// Makes SIGINT and SIGTERM ask for a safe stop: they set a flag and signal the waker. The waker
/// must outlive the process's wish to be stopped; one waker per process.
void stop_on_signals(Waker& waker);
/// Whether SIGINT or SIGTERM has come.
[[nodiscard]] bool stop_was_requested() noexcept;

}  // namespace hybridtest
