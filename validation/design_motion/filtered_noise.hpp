#pragma once

#include <cstddef>
#include <vector>

#include "core/random.hpp"

namespace hybridtest::design_motion {

/// The ground as two oscillators in series: the soil layer transmits and amplifies (Kanai, 1957;
/// Tajimi, 1960), the second removes long periods (Clough and Penzien, 1975).
struct GroundFilter {
  double soil_frequency_rad_per_s = 12.0;  // medium soil: predominant period about 0.5 s
  double soil_damping_ratio = 0.6;
  double high_pass_frequency_rad_per_s = 1.2;
  double high_pass_damping_ratio = 0.6;
};

/// Envelope of the shaking over time: quadratic rise, full strength, exponential decay (Jennings,
/// Housner and Tsai, 1968), and zero at the end.
struct Envelope {
  double rise_s = 3.0;
  double strong_end_s = 15.0;
  double decay_per_s = 0.25;
  double end_s = 31.0;
  double fade_s = 1.0;  // the last part falls to zero as half a cosine wave

  /// 0 to 1.
  [[nodiscard]] double at(double time_s) const noexcept;
};

/// White noise through the ground filter, times the envelope. [1], to be scaled.
/// @param count   samples, the first at time 0.
[[nodiscard]] std::vector<double> filtered_noise(Random& random, const GroundFilter& filter, const Envelope& envelope,
                                                 double dt_s, std::size_t count);

}  // namespace hybridtest::design_motion
