#pragma once

#include <algorithm>
#include <cmath>

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
    const double k1 = slope(z, direction);
    const double k2 = slope(z + 0.5 * step * k1, direction);
    const double k3 = slope(z + 0.5 * step * k2, direction);
    const double k4 = slope(z + step * k3, direction);
    z = std::clamp(z + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4), -1.0, 1.0);
  }
  return z;
}

}  // namespace hybridtest
