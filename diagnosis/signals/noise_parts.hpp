#pragma once

#include <span>

namespace hybridtest {

/// Noise of a sensor: white, and beside it autoregressive of first order, whose autocorrelation over a time t is
/// exp(-t / correlation time).
struct NoiseParts {
  double white = 0.0;               // standard deviation
  double coloured = 0.0;            // standard deviation; 0: white alone explains it
  double correlation_time_s = 0.0;  // of the coloured part; 0 without one
};

/// The two parts in what a model leaves of a signal.
///
/// As in an Allan variance (Allan, Proceedings of the IEEE 54, 1966), means over 1, 2, 4 … samples tell the colour: of
/// white noise their variance falls with their length, of coloured noise later. Third differences of neighbouring means
/// are taken, so that slow motion does not count, and their median, so that jumps do not. Both parts are fitted to
/// their logarithms, from single samples up to the longest means that they explain.
///
/// A misfit is not taken for noise: the coloured part is 0 unless it explains the means better than chance allows, and
/// both parts together explain the remainder up to twice its floor.
/// @param remainder   measured minus modelled.
[[nodiscard]] NoiseParts noise_parts(std::span<const double> remainder, double period_s);

}  // namespace hybridtest
