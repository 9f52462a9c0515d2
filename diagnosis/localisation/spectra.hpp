#pragma once

#include <complex>
#include <span>
#include <vector>

namespace hybridtest {

/// One-sided spectra of two signals at evenly spaced frequencies, from zero to half the sampling rate.
struct Spectra {
  double resolution_hz = 0.0;
  std::size_t averages = 0;   // segments behind every value
  std::vector<double> input;  // power spectral density, unit squared per Hz
  std::vector<double> output;
  std::vector<std::complex<double>> cross;  // of output against input

  [[nodiscard]] double frequency_hz(std::size_t i) const noexcept { return static_cast<double>(i) * resolution_hz; }
  /// Share of the output's power that goes linearly with the input, 0 to 1. With n averages it is
  /// about 1/n for signals that have nothing to do with each other.
  [[nodiscard]] double coherence(std::size_t i) const noexcept;
};

/// Welch's estimate (IEEE Trans. Audio and Electroacoustics 15(2), 1967): Hann windows that overlap
/// by half, each segment less its mean. The densities integrate to the variances.
/// @param segment   samples; a power of two, at least 16 and no longer than the signals.
[[nodiscard]] Spectra welch(std::span<const double> input, std::span<const double> output, double period_s,
                            std::size_t segment);

/// A segment length that leaves at least eight averages where the signal allows.
[[nodiscard]] std::size_t welch_segment(std::size_t samples) noexcept;

}  // namespace hybridtest
