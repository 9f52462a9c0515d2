#pragma once

#include <chrono>
#include <cstdint>
#include <limits>

namespace hybridtest {

/// Spans of time, whole nanoseconds.
using Duration = std::chrono::duration<std::int64_t, std::nano>;

/// The clock of all nodes. It cannot be read: a Node that called
/// `now()` would behave differently under simulated time, so the call does not compile.
struct HandedClock {
  using duration = Duration;
  using rep = Duration::rep;
  using period = Duration::period;
  using time_point = std::chrono::time_point<HandedClock>;
  static constexpr bool is_steady = true;
  static time_point now() = delete;
};

/// A time point of one process's own clock; instants of two processes do not compare.
using Instant = HandedClock::time_point;

/// "Wake me only when a message arrives."
inline constexpr Instant kNever{Duration{std::numeric_limits<std::int64_t>::max()}};

[[nodiscard]] constexpr double to_seconds(Duration duration) noexcept {
  return static_cast<double>(duration.count()) * 1e-9;
}

/// Rounds to the nearest nanosecond. @param seconds finite, magnitude below 9e9 s.
[[nodiscard]] constexpr Duration from_seconds(double seconds) noexcept {
  const double nanoseconds = seconds * 1e9;
  return Duration{static_cast<std::int64_t>(nanoseconds + (nanoseconds < 0.0 ? -0.5 : 0.5))};
}

}  // namespace hybridtest
