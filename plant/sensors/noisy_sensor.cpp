#include "plant/sensors/noisy_sensor.hpp"

#include <cmath>

#include "core/parameters/checked_parameter.hpp"

namespace hybridtest {

NoisySensor::NoisySensor(double noise, Random random) : NoisySensor{noise, random, {}} {}

NoisySensor::NoisySensor(double noise, Random random, const Coloured& coloured)
    : noise_{checked("noise", noise, kNotNegative)},
      initial_random_{random},
      random_{random},
      coloured_{coloured},
      initial_coloured_random_{coloured.random} {
  expect_in_range("coloured noise", coloured_.noise, kNotNegative);
  const double correlation =
      checked("correlation", coloured_.correlation, {.low = 0.0, .high = 1.0, .high_open = true});
  innovation_ = std::sqrt(1.0 - correlation * correlation);
  reset();
}

void NoisySensor::reset() noexcept {
  random_ = initial_random_;
  coloured_.random = initial_coloured_random_;
  state_ = coloured_.random.normal();
}

}  // namespace hybridtest
