#pragma once

#include <cmath>
#include <numbers>

#include "compensation/delay_estimator.hpp"
#include "core/random.hpp"

namespace hybridtest {

/// A motion of 5 mm that sweeps from 0.5 to 5 Hz over twenty seconds.
inline double chirp_m(double time_s) {
  return 5e-3 * std::sin(2.0 * std::numbers::pi * (0.5 + 0.5 * (5.0 - 0.5) / 20.0 * time_s) * time_s);
}

inline double sine_m(double frequency_hz, double time_s) {
  return 5e-3 * std::sin(2.0 * std::numbers::pi * frequency_hz * time_s);
}

/// Feeds `seconds` of a motion and the same motion `delay_s` late, times `gain`, with noise of the measurement.
/// @param motion   time [s] -> displacement [m]
/// @return the estimate at the end
template <class Motion>
double estimate_of(DelayEstimator& estimator, Motion motion, double delay_s, double period_s, double seconds,
                   double gain = 1.0, double noise_m = 0.0) {
  Random random{23};
  const int samples = static_cast<int>(std::lround(seconds / period_s));
  double estimate_s = estimator.delay_s();
  for (int i = 0; i < samples; ++i) {
    const double t = period_s * i;
    estimate_s = estimator.estimate({motion(t), gain * motion(t - delay_s) + noise_m * random.normal()});
  }
  return estimate_s;
}

}  // namespace hybridtest
