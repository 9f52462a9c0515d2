#pragma once

#include <cstddef>

/// Every number of the diagnosis that was chosen and not derived, with what it was chosen for.
namespace hybridtest::tuning {

/// Rate at which predictions are compared [Hz]. Ten samples per cycle of the fastest motion that
/// servo-hydraulic actuators follow (about 25 Hz).
inline constexpr double kFitRate_hz = 250.0;

/// Share of the signal that no model is expected to reproduce: keeps noise-free records from being
/// judged by rounding, and weighs interfaces against each other.
inline constexpr double kModelAllowance = 0.003;

/// Held-out blocks per recording; as many as cycles allow within these.
inline constexpr double kFewestBlocks = 5.0;
inline constexpr double kMostBlocks = 12.0;

/// How far a search goes: its steps, the relative gain below which it stops, and how many of the
/// starts it follows.
inline constexpr int kSearchIterations = 12;
inline constexpr double kSearchTolerance = 1e-5;
inline constexpr std::size_t kRefinedStarts = 2;

/// Independent samples that a second of a structured residual is worth.
inline constexpr double kIndependentPerSecond = 5.0;
/// What leaving the model's slightly wrong parameters free costs a candidate [nats].
inline constexpr double kNuisanceCost = 3.0;
/// How many of the screened second effects are refitted together with the first.
inline constexpr std::size_t kRefittedPairs = 4;

/// Gain over the model as it is above which there is something to explain [nats].
inline constexpr double kDetectionGain = 5.0;
/// A further effect is taken when it gains so much [nats] and leaves less than this share of what was left.
inline constexpr double kAnotherEffectGain = 6.0;
inline constexpr double kAnotherEffectLeaves = 0.6;
/// Of the gap: with less left than this nobody looks for a further effect.
inline constexpr double kNothingLeft = 0.01;
/// How many of the best single effects a second one is looked for beside, and the most effects together.
inline constexpr std::size_t kLeadersPaired = 2;
inline constexpr std::size_t kMostEffects = 4;

}  // namespace hybridtest::tuning
