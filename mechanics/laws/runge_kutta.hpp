#pragma once

namespace hybridtest {

/// One step of the classical Runge-Kutta method (Kutta, 1901) for y' = slope(y).
template <class Slope>
[[nodiscard]] double runge_kutta_step(double y, double step, Slope&& slope) noexcept {
  const double k1 = slope(y);
  const double k2 = slope(y + 0.5 * step * k1);
  const double k3 = slope(y + 0.5 * step * k2);
  const double k4 = slope(y + step * k3);
  return y + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
}

}  // namespace hybridtest
