#include "plant/sensors/noisy_sensor.hpp"

#include "core/parameters/checked_parameter.hpp"

namespace hybridtest {

NoisySensor::NoisySensor(double noise, Random random)
    : noise_{checked("noise", noise, kNotNegative)}, initial_random_{random}, random_{random} {}

}  // namespace hybridtest
