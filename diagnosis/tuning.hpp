#pragma once

#include <cstddef>

/// Every number of the diagnosis that was chosen and not derived, with what it was chosen for.
namespace hybridtest::tuning {

/// Rate at which predictions are compared [Hz]. Ten samples per cycle of the fastest motion that
/// servo-hydraulic actuators follow (about 25 Hz).
inline constexpr double kFitRate_hz = 250.0;

/// Share of the signal that no model is expected to reproduce: keeps noise-free records from being
/// judged by rounding, and weighs interfaces against each other.
inline constexpr double kModelAllowance = 0.0005;

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
/// Share of the secant stiffness by which a slightly wrong model may be off.
inline constexpr double kSlightlyWrong = 0.25;
/// By how much a sensor's effect has to be better than a stage's of equal shape [nats].
inline constexpr double kSensorPrior = 1.0;
/// By how much an effect has to be better for each parameter that it has more than another [nats]: of two that do
/// equally well on data not fitted, the simpler one is meant. Half the logarithm of the independent samples of 30 s.
inline constexpr double kParameterPrior = 2.5;
/// An effect so far behind the best one on the coarse record is not looked at again, nor paired [nats].
inline constexpr double kFarBehind = 25.0;
/// How many of the screened second effects are searched together with the first.
inline constexpr std::size_t kRefittedPairs = 5;

/// Gain over the model as it is above which there is something to explain [nats].
inline constexpr double kDetectionGain = 5.0;
/// A further effect is taken when it gains so much [nats] and leaves less than this share of what was left
/// in the median recording.
inline constexpr double kAnotherEffectGain = 6.0;
inline constexpr double kAnotherEffectLeaves = 0.6;
/// Share of that recording's whole gap [variance] that it has to explain unless it is but a wrong number of the model.
inline constexpr double kAnotherEffectExplains = 0.03;
/// Unless it leaves less than this share of what was left.
inline constexpr double kSmallEffectLeaves = 0.15;
/// Of what the best further effect explains: a wrong number of the model that explains so much is taken in its place.
inline constexpr double kNumberInstead = 0.95;
/// Of the gap: with less left than this, or not clearly above the floor, nobody looks for a further effect.
inline constexpr double kNothingLeft = 0.002;
/// How many of the best single effects a second one is looked for beside, and the most effects together.
inline constexpr std::size_t kLeadersPaired = 2;
inline constexpr std::size_t kMostEffects = 4;

/// A gap below this share of its floor [rms over rms] is none.
inline constexpr double kGapOverFloor = 0.3;
/// A gap above this multiple of its floor that nothing reduces is unknown.
inline constexpr double kUnknownOverFloor = 2.0;
/// A signal within this multiple of its noise [standard deviations] shows nothing, and that no gap is seen in it means
/// nothing; at the larger one an effect of a tenth of the signal stands out as far.
inline constexpr double kExcitedOverNoise = 3.0;
inline constexpr double kWellExcitedOverNoise = 30.0;
/// An interface is at fault when its residual exceeds its floor by this factor.
inline constexpr double kFaultOverFloor = 1.15;
/// Beside a gap of more than this multiple of its floor smaller ones count as none.
inline constexpr double kSuspectOverFloor = 2.0;
/// Share of the repeatable gap [variance] up to which its cause is named, and up to which it is named in part.
inline constexpr double kNamedLeaves = 0.0625;
inline constexpr double kPartialLeaves = 0.3;
/// Likewise where everything is computed and nothing measured: wrong ratios come within a hundredth, right ones
/// within rounding.
inline constexpr double kComputedLeaves = 1e-6;
/// Share of the gap [variance] on recordings not fitted that a cause has to be able to remove.
inline constexpr double kCarriesOver = 0.5;
/// Probabilities are the softmax of the scores over this: fitted on development batches, where the first of a set was
/// right more often than the scores alone say.
inline constexpr double kTemperature = 0.5;
/// A set holds the most probable effects until they are this probable together.
inline constexpr double kCredible = 0.9;

}  // namespace hybridtest::tuning
