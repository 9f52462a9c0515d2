#include "experimental_site/sensors/noisy_sensor.hpp"

#include "mechanics/checked_parameter.hpp"

namespace hybridtest {

NoisySensor::NoisySensor(double noise, Random random)
    : noise_{checked("noise", noise, config::kNotNegative)}, initial_random_{random}, random_{random} {}

}  // namespace hybridtest
