#pragma once

#include "validation/studies/compensation_methods.hpp"
#include "validation/studies/compensator_character/test_stand.hpp"

namespace hybridtest::character {

/// Noise gain of a method: root mean square of white noise out over in, while the target is a sine of 3 mm and 1 Hz.
/// Computed from the difference of two runs, with and without the noise.
struct NoiseGain {
  double target_to_command = 0.0;        // []
  double displacement_to_command = 0.0;  // [] of the displacement sensor
  double force_to_force = 0.0;           // [] of the load cell, to the force that the structure receives
  double displacement_to_force_n_per_m = 0.0;
};

[[nodiscard]] NoiseGain measured_noise_gain(const CompensationMethod& method, const StandKind& stand);

}  // namespace hybridtest::character
