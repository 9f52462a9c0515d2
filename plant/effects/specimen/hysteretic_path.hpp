#pragma once

#include <algorithm>
#include <cmath>

#include "mechanics/laws/runge_kutta.hpp"

namespace hybridtest {

/// Carries a hysteretic variable z, which dz = slope(z, direction) ds moves along a way s counted in its own
/// length: classical Runge-Kutta in substeps that samples of a test hardly ever need a second one of. A
/// diagnosis runs an element some ten thousand times over a recording; the laws of mechanics/, which
/// follow every corner to rounding, cost a hundred times as much there.
/// @param way       in units of the length; signed.
/// @param substep   the longest; the error over a unit of way is about its fourth power / 100.
template <class Slope>
[[nodiscard]] double carried_along(double z, double way, double substep, Slope&& slope) noexcept {
  constexpr double kSubstepsMax = 160.0;  // of a longer way only the end matters
  const double direction = way < 0.0 ? -1.0 : 1.0;
  const double substeps = std::clamp(std::ceil(std::abs(way) / substep), 1.0, kSubstepsMax);
  const double step = direction * std::min(std::abs(way) / substeps, substep);
  for (double i = 0.0; i < substeps; ++i) {
    z = std::clamp(runge_kutta_step(z, step, [&](double at) { return slope(at, direction); }), -1.0, 1.0);
  }
  return z;
}

}  // namespace hybridtest
