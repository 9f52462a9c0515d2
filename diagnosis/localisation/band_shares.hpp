#pragma once

#include <vector>

#include "diagnosis/localisation/gap_signals.hpp"
#include "diagnosis/localisation/spectra.hpp"

namespace hybridtest {

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

}  // namespace hybridtest
