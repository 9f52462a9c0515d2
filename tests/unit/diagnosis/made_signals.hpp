#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <vector>

#include "core/random.hpp"

namespace hybridtest {

inline constexpr double kMadePeriod_s = 0.001;

/// A function of time at `count` samples of 1 ms.
inline std::vector<double> sampled(std::size_t count, const std::function<double(double time_s)>& value) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = value(static_cast<double>(i) * kMadePeriod_s);
  return values;
}

inline double sine(double frequency_hz, double time_s) {
  return std::sin(2.0 * std::numbers::pi * frequency_hz * time_s);
}

inline std::vector<double> white_noise(std::size_t count, double deviation, std::uint64_t stream) {
  Random random{1, stream};
  std::vector<double> values(count);
  for (double& value : values) value = deviation * random.normal();
  return values;
}

/// As a converter with steps of this size reads them.
inline std::vector<double> in_steps(std::vector<double> values, double step) {
  for (double& value : values) value = step * std::round(value / step);
  return values;
}

}  // namespace hybridtest
