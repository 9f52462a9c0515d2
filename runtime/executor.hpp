#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

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
  /// When this clock stood at zero: [s] since 1970-01-01T00:00:00Z by the wall clock of now.
  [[nodiscard]] double zero_unix_s() const noexcept;
  /// The deadline for a wait; kNever means no deadline.
  [[nodiscard]] std::chrono::steady_clock::time_point deadline(Instant instant) const noexcept {
    if (instant == kNever) return std::chrono::steady_clock::time_point::max();
    return start_ + instant.time_since_epoch();
  }

 private:
  std::chrono::steady_clock::time_point start_;
};

/// Runs a Node on the calling thread until `is_done`. Advances it when it is due or when a message has
/// arrived, and sleeps on absolute deadlines in between.
///
/// `between` is called after each advance(), for work that a Node may not do: stop requests, logging,
/// recording failures.
void run_until(Node& node, Waker& waker, const ProcessClock& clock, const std::function<bool()>& is_done,
               const std::function<void(Instant)>& between);

/// Sleeps until the instant; signals do not end the sleep. No lock, no allocation.
void rest_until(const ProcessClock& clock, Instant instant) noexcept;

/// Sleeps in intervals of one millisecond while the condition is true.
void wait_while(const std::function<bool()>& condition);

/// Makes each signal that would end the process, and that can be caught, request a safe stop instead: a closed
/// terminal (SIGHUP) ends a site as SIGTERM does. Call it before the first thread and the first file. A signal that
/// the parent made this process ignore (`nohup`) stays ignored. SIGPIPE and SIGXFSZ are ignored: the write that
/// failed reports its error.
void catch_stop_signals();
/// From now on a stop request also signals this waker, which must live until the process ends.
void wake_on_stop(Waker& waker) noexcept;
/// Whether a stop has been requested.
[[nodiscard]] bool stop_was_requested() noexcept;
/// Name of the first signal that requested it, such as "SIGHUP"; empty before.
[[nodiscard]] std::string stop_signal();

}  // namespace hybridtest
