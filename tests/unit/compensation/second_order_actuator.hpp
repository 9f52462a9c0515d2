#pragma once

#include <cmath>

namespace hybridtest {

/// An actuator that obeys a0 x + a1 x' + a2 x'' = u, u held over a period, by Runge-Kutta.
struct SecondOrderActuator {
  double a0 = 1.0;
  double a1_s = 0.0;
  double a2_s2 = 0.0;
  double displacement_m = 0.0;
  double velocity_m_per_s = 0.0;

  void advance(double command_m, double period_s) {
    constexpr int kSteps = 8;
    const double h = period_s / kSteps;
    const auto acceleration = [&](double x, double v) { return (command_m - a0 * x - a1_s * v) / a2_s2; };
    for (int i = 0; i < kSteps; ++i) {
      const double x = displacement_m;
      const double v = velocity_m_per_s;
      const double k1 = acceleration(x, v);
      const double k2 = acceleration(x + 0.5 * h * v, v + 0.5 * h * k1);
      const double k3 = acceleration(x + 0.5 * h * v + 0.25 * h * h * k1, v + 0.5 * h * k2);
      const double k4 = acceleration(x + h * v + 0.5 * h * h * k2, v + h * k3);
      displacement_m += h * v + h * h / 6.0 * (k1 + k2 + k3);
      velocity_m_per_s += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
  }
};

}  // namespace hybridtest
