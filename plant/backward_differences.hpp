#pragma once

#include <array>

#include "plant/effects/effect.hpp"

namespace hybridtest {

/// Velocity and acceleration of sampled displacements from the past alone, of second order: what is late of them is of
/// the order of the square of the period. First differences would be late by a half and by a whole period, which acts
/// on a damper or a mass as a time skew of its force.
///
///     v = (3 x0 - 4 x1 + x2) / (2 T)          x0, x1 ...: displacement now, one period ago ...
///     a = (2 x0 - 5 x1 + 4 x2 - x3) / T^2
///
/// (Fornberg, Mathematics of Computation 51, 1988, table 3.) Before the first sample the displacement is zero.
class BackwardDifferences {
 public:
  /// @param period_s   from one sample to the next, positive.
  explicit BackwardDifferences(double period_s) : period_s_{period_s} {}

  [[nodiscard]] Motion moved_to(double displacement_m) noexcept {
    const auto [x1, x2, x3] = before_m_;
    before_m_ = {displacement_m, x1, x2};
    // By the steps, so that what stands still has no velocity at all: a power of it below one would be a force.
    const double step_m = displacement_m - x1;
    const double step_before_m = x1 - x2;
    return {.displacement_m = displacement_m,
            .velocity_m_per_s = (3.0 * step_m - step_before_m) / (2.0 * period_s_),
            .acceleration_m_per_s2 = (2.0 * step_m - 3.0 * step_before_m + (x2 - x3)) / (period_s_ * period_s_)};
  }
  void reset() noexcept { before_m_ = {}; }

 private:
  double period_s_;
  std::array<double, 3> before_m_{};
};

}  // namespace hybridtest
