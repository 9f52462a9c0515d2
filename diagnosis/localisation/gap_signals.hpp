#pragma once

#include <cstddef>
#include <span>

namespace hybridtest {

/// What is known of one interface at every sample: evenly spaced, all of one length, finite.
struct GapSignals {
  double period_s = 0.0;
  std::span<const double> input_m;   // displacement that drove the interface
  std::span<const double> measured;  // what came out [m] or [N]
  std::span<const double> residual;  // measured less modelled, in the unit of `measured`

  [[nodiscard]] std::size_t size() const noexcept { return residual.size(); }
  [[nodiscard]] double duration_s() const noexcept { return static_cast<double>(size()) * period_s; }
};

/// Mean square; 0 for nothing.
[[nodiscard]] double mean_square(std::span<const double> values) noexcept;
/// Mean square about the mean.
[[nodiscard]] double variance(std::span<const double> values) noexcept;

}  // namespace hybridtest
