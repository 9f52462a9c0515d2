#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "diagnosis/signals/signals.hpp"

namespace hybridtest {

/// Energy of the residual over a stretch of time.
struct TimeWindow {
  double begin_s = 0.0;
  double end_s = 0.0;
  double share = 0.0;  // of the residual's energy over the whole recording
  double nrmse = 0.0;  // root mean square of the residual here over that of the output of the whole recording
};

/// Cuts the recording into `count` stretches as equal as samples allow; their shares add up to one
/// unless there is no residual at all.
[[nodiscard]] std::vector<TimeWindow> gap_over_time(const GapSignals& signals, std::size_t count);

/// The fewest of the windows that hold `share` of the energy, neighbours joined, in order of time.
[[nodiscard]] std::vector<TimeWindow> windows_holding(const std::vector<TimeWindow>& windows, double share);

/// One-sided spectra of two signals at evenly spaced frequencies, from zero to half the sampling rate.
struct Spectra {
  double resolution_hz = 0.0;
  std::size_t averages = 0;   // segments behind every value
  std::vector<double> input;  // power spectral density, unit squared per Hz
  std::vector<double> output;
  std::vector<std::complex<double>> cross;  // of output against input

  [[nodiscard]] double frequency_hz(std::size_t i) const noexcept { return static_cast<double>(i) * resolution_hz; }
  /// Share of the output's power that goes linearly with the input, 0 to 1. With n averages it is
  /// about 1/n for uncorrelated signals.
  [[nodiscard]] double coherence(std::size_t i) const noexcept;
};

/// Welch's estimate (IEEE Trans. Audio and Electroacoustics 15(2), 1967): Hann windows that overlap
/// by half, each segment less its mean. The densities integrate to the variances.
/// @param segment   samples; a power of two, at least 16 and no longer than the signals.
[[nodiscard]] Spectra welch(std::span<const double> input, std::span<const double> output, double period_s,
                            std::size_t segment);

/// A segment length that leaves at least eight averages where the signal allows.
[[nodiscard]] std::size_t welch_segment(std::size_t samples) noexcept;

/// Energy of the residual in a frequency band.
struct BandShare {
  double low_hz = 0.0;
  double high_hz = 0.0;
  double share = 0.0;      // of the residual's variance, mean and trend of segments left out
  double nrmse = 0.0;      // root mean square of the residual here over that of the whole output
  double coherence = 0.0;  // residual against input, weighted by the residual's power: near one is linear
};

/// Half-octave bands up to half the sampling rate; the first one begins at zero.
[[nodiscard]] std::vector<BandShare> gap_over_frequency(const GapSignals& signals, const Spectra& spectra);

/// The fewest of the bands that hold `share` of the energy, neighbours joined, in order of frequency.
[[nodiscard]] std::vector<BandShare> bands_holding(const std::vector<BandShare>& bands, double share);

/// Energy of the residual where some quantity lies in a range.
struct GapBin {
  double low = 0.0;
  double high = 0.0;
  std::size_t samples = 0;
  double share = 0.0;  // of the residual's energy
  double nrmse = 0.0;  // root mean square of the residual here over that of the whole output
};

/// Over one quantity per sample (distance since reversal, cycles completed): `bins` ranges of equal
/// width from 0 to its largest value.
[[nodiscard]] std::vector<GapBin> gap_over(const GapSignals& signals, std::span<const double> quantity,
                                           std::size_t bins);

/// Over |displacement| and |velocity| of the input, as a table; cells without samples have none.
struct MotionMap {
  double peak_m = 0.0;
  double peak_m_per_s = 0.0;
  std::size_t displacement_bins = 0;
  std::size_t velocity_bins = 0;
  std::vector<GapBin> cells;  // row by row, a row being a range of velocity; low and high are not filled

  [[nodiscard]] const GapBin& at(std::size_t displacement_bin, std::size_t velocity_bin) const {
    return cells[velocity_bin * displacement_bins + displacement_bin];
  }
};
[[nodiscard]] MotionMap gap_over_motion(const GapSignals& signals, std::size_t displacement_bins,
                                        std::size_t velocity_bins);

/// Central differences over `reach_s` either way, shorter at the ends. For maps and screens: noise of a
/// displacement shrinks with the reach, motion faster than about 0.1 / reach is damped.
[[nodiscard]] std::vector<double> velocity_of(std::span<const double> displacement_m, double period_s, double reach_s);

}  // namespace hybridtest
