#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "compensation/sample_history.hpp"

namespace hybridtest {

/// value(t) = constant + linear t + square t^2, t in seconds, 0 at the newest sample.
struct Quadratic {
  double constant = 0.0;
  double linear = 0.0;
  double square = 0.0;

  [[nodiscard]] double at(double time_s) const noexcept { return constant + time_s * (linear + time_s * square); }
};

/// Least-squares quadratic through equally spaced samples of a signal, the newest among them. Three
/// points are interpolated, more are smoothed.
class QuadraticFit {
 public:
  /// @param points    at least 3.
  /// @param spacing   samples from one point to the next, at least 1.
  QuadraticFit(std::size_t points, std::size_t spacing, double sample_period_s);

  /// Samples that a history needs to hold.
  [[nodiscard]] std::size_t span() const noexcept { return (points_ - 1) * spacing_ + 1; }
  /// @param history   of span() samples or more.
  [[nodiscard]] Quadratic fit(const SampleHistory& history) const noexcept;

 private:
  std::size_t points_;
  std::size_t spacing_;
  std::vector<std::array<double, 3>> weights_;  // of each point, newest first
};

}  // namespace hybridtest
