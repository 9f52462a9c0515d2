#pragma once

#include <span>

namespace hybridtest {

/// What a coarse converter left in readings.
struct ReadingSteps {
  double step = 0.0;       // q; 0: none found
  double coherence = 0.0;  // 0 to 1: how far readings keep to multiples of it, up to an offset; 1: all do
};

/// The characteristic function of quantized readings repeats at 1 / q (Widrow and Kollar, Quantization Noise, 2008,
/// chapter 4): along the way of the signal, |mean exp(2 pi i y / q)| is exp(-2 (pi s / q)^2) for noise s that was added
/// behind the converter, and about q per way between reversals without one.
///
/// Steps between a sixth of the span and twice the white noise of the readings are looked for; of several that divide
/// each other the largest is meant.
/// @param values   finite.
[[nodiscard]] ReadingSteps steps_of_readings(std::span<const double> values);

}  // namespace hybridtest
