#pragma once

#include <cstdint>

namespace hybridtest {

/// A sine that grows along a raised cosine over `ramp_s` from its beginning and fades likewise to its end:
/// amplitude sin(2 pi f t). Zero before time 0 and after the duration.
struct HarmonicSignal {
  double amplitude = 0.0;
  double frequency_hz = 1.0;
  double duration_s = 0.0;
  double ramp_s = 0.0;  // at most half of the duration

  [[nodiscard]] double at(double time_s) const noexcept;
};

enum class SweepType : std::uint8_t { linear, logarithmic };

/// A sine whose frequency goes from `from_hz` to `to_hz` in `duration_s`, up or down: linearly in time, f = f0 + k t,
/// or logarithmically, f = f0 (f1/f0)^(t/T), with as much time in each octave. Ramps as HarmonicSignal.
struct SweepSignal {
  double amplitude = 0.0;
  double from_hz = 1.0;
  double to_hz = 1.0;
  double duration_s = 0.0;
  SweepType type = SweepType::linear;
  double ramp_s = 0.0;

  [[nodiscard]] double at(double time_s) const noexcept;
};

}  // namespace hybridtest
