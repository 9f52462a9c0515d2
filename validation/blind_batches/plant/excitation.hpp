#pragma once

#include "validation/blind_batches/plant/history.hpp"
#include "validation/blind_batches/plant/random_stream.hpp"

namespace hybridtest::blind {

struct ExcitationSettings {
  double rate_hz = 0.0;
  double duration_s = 0.0;
  double stroke_m = 0.0;          // largest displacement
  double velocity_m_per_s = 0.0;  // about the largest velocity: limits the frequencies
  double rest_s = 0.0;            // at either end; 0: none
};

/// A displacement history that begins and ends at zero: the drift of an oscillator under
/// filtered noise, a sine sweep, a growing sinusoid, a protocol of growing cycles, or band noise.
[[nodiscard]] History draw_excitation(const ExcitationSettings& settings, RandomStream& random);

}  // namespace hybridtest::blind
