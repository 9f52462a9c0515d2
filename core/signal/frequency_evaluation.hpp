#pragma once

#include <complex>
#include <cstddef>
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

/// The same of signals that are too long for one transform: the sums over the frequencies go over blocks of them, as in
/// the estimator H1 of Bendat and Piersol, Random Data. Each block is less its mean and tapered.
class FrequencyEvaluationSum {
 public:
  /// @param length   of the transforms, a power of two of at least 16 and the size of every block: a shorter one is
  /// followed by
  ///                 zeros.
  FrequencyEvaluationSum(double period_s, std::size_t length);

  /// @param target, measured   of equal size, at least one value.
  void add(std::span<const double> target, std::span<const double> measured);
  /// @return nothing where evaluate_tracking_frequency() returns nothing.
  [[nodiscard]] std::optional<FrequencyEvaluation> result() const;

 private:
  double period_s_;
  std::size_t length_;
  std::size_t samples_ = 0;
  bool target_moves_ = false;
  bool measured_moves_ = false;
  std::complex<double> cross_{};
  double input_power_ = 0.0;
  double output_power_ = 0.0;
  double frequency_moment_ = 0.0;
};

}  // namespace hybridtest
