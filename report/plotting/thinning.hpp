#pragma once

#include <cstddef>
#include <vector>

namespace hybridtest::plot {

/// Points of a curve; a point that is not finite is a gap.
struct Points {
  std::vector<double> x;
  std::vector<double> y;
};

/// Thins a curve while it is read: of the points that follow each other in one column, it keeps the lowest and the
/// highest, in their order. So no peak is lost, and memory does not grow with the length of a history.
class HistoryThinner {
 public:
  /// @param low, high   of x; points outside belong to the columns at the ends.
  /// @param columns     at least 1.
  HistoryThinner(double low, double high, std::size_t columns);

  void add(double x, double y);
  /// The curve so far, with its very first and last point.
  [[nodiscard]] Points take();

 private:
  struct Point {
    double x = 0.0;
    double y = 0.0;
  };
  void keep(const Point& point);
  void end_column();

  double low_;
  double columns_per_x_;
  double last_column_;
  Points kept_;
  double column_ = -1.0;  // -1: none is open
  Point least_;
  Point most_;
  Point last_;
  bool least_is_first_ = true;
};

/// Thins a curve that runs to and fro, such as force over displacement: a point is kept when it is far enough from the
/// last that was kept, in shares of the range so far. Where too many remain, the distance doubles.
class LoopThinner {
 public:
  /// @param most   points kept, at least 16.
  explicit LoopThinner(std::size_t most);

  void add(double x, double y);
  [[nodiscard]] Points take();

 private:
  [[nodiscard]] bool is_far(double x, double y) const noexcept;
  void thin_again();

  std::size_t most_;
  double distance_;  // [-] of the range
  Points kept_;
  double x_low_;
  double x_high_;
  double y_low_;
  double y_high_;
  double last_x_;
  double last_y_;
};

}  // namespace hybridtest::plot
