#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/random.hpp"

namespace hybridtest {

/// Noise of a channel: first-order autoregressive, with hum of the mains beside it.
struct MadeNoise {
  double correlation = 0.0;  // of neighbouring samples; 0: white
  double hum_share = 0.0;    // root mean square of a 50 Hz line over the whole
};

/// `count` samples of root mean square `level`, on average.
inline std::vector<double> made_noise(const MadeNoise& kind, std::size_t count, double level, double period_s,
                                      std::uint64_t stream) {
  Random random{11, stream};
  const double innovation = std::sqrt(1.0 - kind.correlation * kind.correlation);
  const double phase = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double rest = std::sqrt(1.0 - kind.hum_share * kind.hum_share);
  double state = random.normal();
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    state = kind.correlation * state + innovation * random.normal();
    const double time_s = period_s * static_cast<double>(i);
    const double hum = std::numbers::sqrt2 * std::sin(100.0 * std::numbers::pi * time_s + phase);
    values[i] = level * (rest * state + kind.hum_share * hum);
  }
  return values;
}

}  // namespace hybridtest
