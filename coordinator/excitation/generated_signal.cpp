#include "coordinator/excitation/generated_signal.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hybridtest {
namespace {

/// 0 outside, 1 between the ramps.
double envelope(double time_s, double duration_s, double ramp_s) noexcept {
  // Written so that NaN counts as outside.
  if (!(time_s >= 0.0 && time_s <= duration_s)) return 0.0;
  const double to_end_s = std::min(time_s, duration_s - time_s);
  if (to_end_s >= ramp_s) return 1.0;
  return 0.5 * (1.0 - std::cos(std::numbers::pi * to_end_s / ramp_s));
}

}  // namespace

double HarmonicSignal::at(double time_s) const noexcept {
  return amplitude * envelope(time_s, duration_s, ramp_s) * std::sin(2.0 * std::numbers::pi * frequency_hz * time_s);
}

double SweepSignal::at(double time_s) const noexcept {
  const double share = time_s / duration_s;
  double cycles = (from_hz + 0.5 * (to_hz - from_hz) * share) * time_s;
  if (type == SweepType::logarithmic && from_hz != to_hz) {
    const double octaves = std::log(to_hz / from_hz);
    cycles = from_hz * duration_s / octaves * std::expm1(octaves * share);
  }
  return amplitude * envelope(time_s, duration_s, ramp_s) * std::sin(2.0 * std::numbers::pi * cycles);
}

}  // namespace hybridtest
