#pragma once

#include <optional>
#include <span>

namespace hybridtest {

/// How a measured signal follows its target: one amplitude and one delay.
struct FrequencyEvaluation {
  double amplitude = 0.0;     // [-] measured over target
  double delay_s = 0.0;       // [s] positive when the measured signal is behind
  double frequency_hz = 0.0;  // [Hz] power-weighted mean frequency of the target
  double coherence = 0.0;     // [-] 0 to 1, share of the measured motion that goes with the target's
};

/// Frequency evaluation index of Guo, Chen, Xu and Sanchez, "A frequency response analysis approach
/// for quantitative assessment of actuator tracking for real-time hybrid simulation", Smart Materials
/// and Structures 23 (2014) 045042, with weights of power l = 2:
///
///   FEI   = Σ (Y/U) |U|² / Σ |U|² = Σ Y conj(U) / Σ |U|²     over the positive frequencies
///   f_eq  = Σ f |U|² / Σ |U|²
///   amplitude = |FEI|,  delay = −arg(FEI) / (2π f_eq)
///
/// U and Y are the discrete Fourier transforms of target and measured signal, less their means and
/// tapered by a cosine over a tenth of the length at either end (Harris, Proc. IEEE 66, 1978), since
/// a test ends elsewhere than it began.
///
/// Delays beyond half a period of f_eq alias. For motions of many frequencies the delay is the
/// power-weighted mean phase lag over f_eq: exact for a pure delay of a single frequency, to second
/// order in (2π f delay) otherwise.
///
/// @param target, measured   of equal size, evenly spaced by `period_s`, finite.
/// @return nothing when the two have fewer than 16 values, the target rests, or less than half of
///         the measured motion goes with the target's, so that its delay would mean nothing.
[[nodiscard]] std::optional<FrequencyEvaluation> evaluate_tracking_frequency(std::span<const double> target,
                                                                             std::span<const double> measured,
                                                                             double period_s);

}  // namespace hybridtest
