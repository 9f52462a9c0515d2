#pragma once

#include <cstdint>
#include <vector>

#include "core/messages.hpp"
#include "core/records.hpp"

namespace hybridtest {

/// What the exchanges of half a second say of the clock of a substructure (two-way time transfer; Mills, RFC 5905,
/// section 8). Of each exchange there are four readings: command sent t1 and answer received t4 by the coordinator's
/// clock, command received t2 and answer sent t3 by the substructure's. With o its clock less the coordinator's,
///
///   there = t2 - t1 = o + latency of the command,      back = t4 - t3 = latency of the answer - o.
///
/// No latency is negative, so that -back <= o <= there in each exchange; the least of both bound it best.
struct ClockWindow {
  std::int64_t exchanges = 0;
  Duration there_at{};  // t1 of the exchange with the least `there`
  Duration least_there = Duration::max();
  Duration back_at{};  // t4 of the one with the least `back`
  Duration least_back = Duration::max();
  double sum_there_s = 0.0;
  double sum_back_s = 0.0;
};

/// Gathers the windows of all substructures. Allocates nothing after its construction.
class ClockWindows {
 public:
  static constexpr Duration kLength = std::chrono::milliseconds{500};

  explicit ClockWindows(std::size_t substructures) : windows_(substructures) {}

  /// @param now   t4.
  void add(const ForceMeasurement& answer, Instant now) noexcept;
  /// Writes the windows that are over, at the end of the test all that have an exchange.
  void record(Instant now, bool at_end, RowSink& rows) noexcept;

  [[nodiscard]] static TableLayout layout();

 private:
  std::vector<ClockWindow> windows_;  // one per substructure
  Instant window_end_ = kNever;
};

}  // namespace hybridtest
