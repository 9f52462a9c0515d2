#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "diagnosis/signals/signals.hpp"

namespace hybridtest {

enum class FloorSource : std::uint8_t { repeated_recordings, repeated_cycles, rest, high_frequencies };
/// As text: `repeated cycles`.
[[nodiscard]] std::string_view name_of(FloorSource source) noexcept;

/// The part of a residual that does not repeat: no model can reproduce it.
struct RepeatabilityFloor {
  double rms = 0.0;  // in the unit of the residual
  FloorSource source = FloorSource::high_frequencies;
};

/// From two recordings of the same test: each has half the variance of the difference of their
/// residuals. Nothing when their inputs differ by more than a hundredth (root mean square).
[[nodiscard]] std::optional<RepeatabilityFloor> floor_of_repetition(const GapSignals& first, const GapSignals& second);

/// Of cycles that repeat their input: the spread of the residual around the mean cycle, taken from
/// stretches of one lag that fits best. Nothing when the input does not come back, within a fiftieth,
/// over at least half of the recording.
[[nodiscard]] std::optional<RepeatabilityFloor> floor_of_cycles(const GapSignals& signals);

/// Of the times at rest (rest_stretches()): the residual's spread around its mean in each. Nothing without any.
[[nodiscard]] std::optional<RepeatabilityFloor> floor_at_rest(const GapSignals& signals);

/// Of the times in which the motion stays within a tenth of its range, as where it turns slowly: what a model has wrong
/// changes little there, and noise is as large as elsewhere [rms]. In each the spread around a line over the input; the
/// median of them. Nothing with fewer than a spectrum is averaged over.
[[nodiscard]] std::optional<double> noise_while_still(const GapSignals& signals);

/// Of the fastest fluctuation, second differences, as if it were white: a lower limit to the floor, an upper one
/// to white noise. @param signals   at least three samples.
[[nodiscard]] RepeatabilityFloor floor_of_high_frequencies(const GapSignals& signals);

/// The best of these that the recording offers: repeated cycles, else the larger of rest and high frequencies.
[[nodiscard]] RepeatabilityFloor repeatability_floor(const GapSignals& signals);

}  // namespace hybridtest
