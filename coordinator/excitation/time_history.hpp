#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace hybridtest {

/// Values at equally spaced times, linear in between, zero before the first and after the last. Times that are samples
/// up to rounding count as samples.
/// @param dt_s      positive.
/// @param start_s   time of the first value.
[[nodiscard]] double interpolated(std::span<const double> values, double dt_s, double start_s, double time_s) noexcept;

/// A quantity over time, in the unit of its values.
struct TimeHistory {
  double dt_s = 0.0;
  double start_s = 0.0;
  std::vector<double> values;

  [[nodiscard]] double at(double time_s) const noexcept { return interpolated(values, dt_s, start_s, time_s); }
};

/// The values at 0, step_s, 2 step_s … last_step step_s.
/// @param step_s   positive. @param last_step   not negative.
[[nodiscard]] std::vector<double> at_steps(const std::function<double(double time_s)>& history, double step_s,
                                           std::int64_t last_step);

}  // namespace hybridtest
