#pragma once

#include <complex>
#include <cstddef>
#include <unsupported/Eigen/FFT>
#include <vector>

namespace hybridtest::run_report {

/// How a measured signal follows its target at one frequency.
struct TransferPoint {
  double frequency_hz = 0.0;
  double amplitude = 0.0;  // [-] measured over target
  double delay_s = 0.0;    // [s] positive when the measured signal is behind
  double coherence = 0.0;  // [-] 0 to 1, share of the measured motion that goes with the target's
};

/// Transfer function from the mean spectra of overlapping segments (Welch, IEEE Trans. Audio Electroacoust. 15, 1967;
/// estimator H1 of Bendat and Piersol, Random Data):
///
///   H = S_uy / S_uu,  coherence = |S_uy|² / (S_uu S_yy),  delay = −arg(H) / (2π f)
///
/// Segments overlap by half, less their means, under a Hann window. Memory does not grow with the signals. Delays
/// beyond half a period of their frequency alias.
class TransferEstimate {
 public:
  /// @param samples   of a segment, a power of two of at least 16.
  TransferEstimate(double period_s, std::size_t samples);

  /// A pair that is not finite begins the segment anew.
  void add(double target, double measured);
  /// Where the target moves and the measured signal goes with it, see tuning.hpp; empty with fewer than two segments.
  [[nodiscard]] std::vector<TransferPoint> points() const;

 private:
  void end_segment();
  [[nodiscard]] std::vector<std::complex<double>> spectrum_of(const std::vector<double>& segment);

  Eigen::FFT<double> transform_;  // keeps its factors from segment to segment
  double period_s_;
  std::size_t samples_;
  std::size_t segments_ = 0;
  std::vector<double> window_;
  std::vector<double> target_;
  std::vector<double> measured_;
  std::vector<double> target_power_;
  std::vector<double> measured_power_;
  std::vector<std::complex<double>> cross_;
};

}  // namespace hybridtest::run_report
