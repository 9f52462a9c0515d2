#pragma once

#include <cstddef>
#include <vector>

#include "core/time.hpp"

namespace hybridtest {

/// A signal some time ago: samples in equal intervals, straight lines between them, zero before
/// the first. The delay is any number of intervals.
class DelayLine {
 public:
  /// @param delay           not negative, at most 100 000 intervals.
  /// @param control_period  the interval; positive.
  /// @throws ConfigError for values outside these ranges.
  DelayLine(Duration delay, Duration control_period);
  /// The same in seconds, not rounded to nanoseconds.
  DelayLine(double delay_s, double period_s);

  /// Takes the newest sample.
  void push(double value) noexcept;
  void reset() noexcept;

  /// The delayed signal at the newest sample.
  [[nodiscard]] double delayed() const noexcept;
  /// The same by the cubic through one sample more on either side (Laakso et al., IEEE Signal Processing Magazine 13,
  /// 1996); within the first interval, where there is no newer one, by the parabola through an older one. Of smooth
  /// signals a straight line takes (2 pi f dt)^2 / 8 off the middle between two samples.
  [[nodiscard]] double delayed_smoothly() const noexcept;
  /// Between two pushes the delayed signal is two straight lines that meet in corner(),
  /// corner_fraction() of the interval after the older push.
  [[nodiscard]] double corner() const noexcept;
  [[nodiscard]] double corner_fraction() const noexcept { return fraction_; }

 private:
  [[nodiscard]] double ago(std::size_t intervals) const noexcept;

  std::size_t whole_intervals_ = 0;
  double fraction_ = 0.0;  // of an interval beyond the whole ones, 0 to less than 1
  std::vector<double> samples_;
  std::size_t newest_ = 0;
};

}  // namespace hybridtest
