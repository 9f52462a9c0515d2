#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <vector>

namespace hybridtest {

/// What a signal did since the point before.
struct LivePoint {
  double model_time_s = 0.0;  // of the newest row
  double least = 0.0;
  double most = 0.0;
  double last = 0.0;  // NaN where there is no value
};

/// A bounded history without lost peaks: points in one interval of model time become one with the extremes of all.
class BinnedPoints {
 public:
  /// @param width_s      of an interval at first; it doubles whenever there are too many points.
  /// @param points_max   at least 2.
  /// @param window_s     points older than this are dropped.
  BinnedPoints(double width_s, std::size_t points_max, double window_s = std::numeric_limits<double>::infinity());

  void add(const LivePoint& point);
  [[nodiscard]] const std::deque<LivePoint>& points() const noexcept { return points_; }

 private:
  void put(const LivePoint& point);

  double width_s_;
  std::size_t points_max_;
  double window_s_;
  std::deque<LivePoint> points_;
};

/// One signal of a test: its newest points as they came, its last 30 s, and the whole test.
class SignalHistory {
 public:
  SignalHistory();

  /// @param cursor   of the message that brought the point.
  /// @return the cursor of the point that was dropped from the newest ones; 0 when none was.
  std::uint64_t add(std::uint64_t cursor, const LivePoint& point);
  /// Another value at the time of the newest point: model time stands still while a test is paused.
  void amend(const LivePoint& point);

  /// Those that came after the cursor, as far as they are still kept one by one.
  [[nodiscard]] std::vector<LivePoint> since(std::uint64_t cursor) const;
  /// The last 30 s of model time.
  [[nodiscard]] std::vector<LivePoint> recent() const;
  /// From the first point on.
  [[nodiscard]] std::vector<LivePoint> whole() const;
  /// Newest; NaN before the first.
  [[nodiscard]] LivePoint newest() const noexcept;
  /// Largest magnitude ever; 0 before the first value.
  [[nodiscard]] double peak() const noexcept { return peak_; }

 private:
  struct Arrived {
    std::uint64_t cursor = 0;
    LivePoint point;
  };

  std::deque<Arrived> newest_;
  BinnedPoints recent_;
  BinnedPoints whole_;
  double peak_ = 0.0;
};

}  // namespace hybridtest
