#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

/// All chosen (not derived) numbers of the diagnosis, by subject, with the reason for each choice. Two kinds
/// are elsewhere: the search ranges of the effects (identification/search_table.hpp) and the layout of the page
/// (page/). tests/architecture/tuning_test.cpp finds any other.
namespace hybridtest::tuning {

// Intake: limits of what is accepted as a recording.

/// Minimum number of rows of data.
inline constexpr std::size_t kSamplesMin = 16;
/// Most rows of data: a diagnosis keeps all of them in memory, with all that it makes of them about 3 kB per row and
/// degree of freedom. 35 minutes at 1 kHz.
inline constexpr std::size_t kSamplesMax = std::size_t{1} << 21U;
/// Largest file that is read: 2 GiB.
inline constexpr std::uintmax_t kFileSizeMax_bytes = std::uintmax_t{1} << 31U;
/// Largest number of columns in a file.
inline constexpr std::size_t kColumnsMax = 200;
/// Largest number of degrees of freedom of one site (the suffix of a column name).
inline constexpr std::size_t kDofsMax = 12;
/// Largest number of different findings that are listed.
inline constexpr std::size_t kFindingsMax = 50;
/// Share of the sample period by which one interval may differ from it.
inline constexpr double kEvenSpacing = 0.01;
/// An interval of more than this many periods is a gap, a shorter one uneven sampling.
inline constexpr double kGapPeriods = 1.5;
/// If the last digit of the time stamps is at most this share of the period, an interval may deviate by this many
/// units of that digit (one, and rounding).
inline constexpr double kLastDigitOfPeriodMax = 0.1;
inline constexpr double kLastDigits = 1.01;
/// Rounding of time stamps far from zero, as a share of them: about two units in the last place.
inline constexpr double kTimeRounding = 4e-16;

// Intake: columns whose unit differs from their header.

/// A displacement or a speed above these is suspected to be in another unit than metres.
inline constexpr double kDisplacementMax_m = 10.0;
inline constexpr double kSpeedMax_m_per_s = 10.0;
/// Time over which that speed is computed.
inline constexpr double kSpeedWindow_s = 0.02;
/// Tolerance of the ratio of two ranges against the ratio of units: channels differ by gain, lag and noise.
inline constexpr double kUnitRatioTolerance = 0.25;
/// Minimum correlation of two channels that are the same motion in different units: two displacements, one of them as
/// late as an actuator is, or a measured acceleration and the second derivative of the displacement. Noise of the
/// latter reduces both by as much as the tolerance of the ratio. A channel with less is at rest, stuck, or another
/// motion.
inline constexpr double kScaledCopyCorrelationMin = 0.8;
/// Minimum correlation of a force with the one that the model predicts.
inline constexpr double kForceCorrelationMin = 0.3;
/// Tolerance (a factor) of the force ratio for another unit. It is wide for a thousand or a million, because no
/// specimen is so much softer than its model, and narrower for 4448 (kips).
inline constexpr double kForceFactor = 3.0;
inline constexpr double kKipsFactor = 1.5;
/// A wrong stiffness can also give a factor of 9.8 or 4.4. For kilograms and pounds of force the tolerance is therefore
/// narrower, and the gap after conversion [rms over rms] must be small.
inline constexpr double kForceOfMassFactor = 1.03;
inline constexpr double kForceOfMassLeaves = 0.1;
/// Longest control period of a recorded controller. With a longer sample period, time is probably in milliseconds or
/// microseconds.
inline constexpr double kControlPeriodMax_s = 0.1;
/// Factor by which another unit of time must reduce the gap, and the largest gap [rms over rms] that may remain.
inline constexpr double kTimeUnitNearer = 3.0;
inline constexpr double kTimeUnitNear = 0.3;

// Signals: smoothing, reversals, rest.

/// Degree of the local polynomials from which derivatives are computed.
inline constexpr std::ptrdiff_t kSmoothingDegree = 4;
/// Half-widths that are tried, in samples, each about 1.4 times the one before.
inline constexpr std::array<std::size_t, 9> kSmoothingHalfWidths{3, 4, 5, 7, 10, 14, 20, 28, 40};
/// Largest residual variance of a wider window over that of white noise alone: the smoothing error then stays below
/// half the noise.
inline constexpr double kSmoothingLeaves = 1.2;
/// Rounding of recorded values, as a share of their mean square.
inline constexpr double kRoundingVariance = 1e-24;
/// Weights of the flat smoother are omitted beyond this many deviations of its widest part: 3e-4 of the largest.
inline constexpr double kSmootherReach = 4.0;
/// Deviations [samples] with which force and motion are both smoothed, each about 1.4 times the one before.
inline constexpr std::array kSmoothingDeviations{0.0, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0, 11.0, 16.0, 23.0, 32.0};
/// The chosen deviation over the best one. At the best one, smoothing removes as much motion as noise remains. The
/// force is smoothed in the same way, so this loss does no harm, and the next wider deviation has less noise.
inline constexpr double kSmoothingNextStep = 1.4;
/// A reversal is a motion back by more than this share of the whole range: more than noise causes.
inline constexpr double kReversalShare = 0.02;
/// Rest: for this time the motion stays within this share of its whole range.
inline constexpr double kRestLength_s = 0.2;
inline constexpr double kRestSpan = 0.001;
/// Half-width of the central differences of maps and screens: long enough for 10 um of noise, short enough for 20 Hz.
inline constexpr double kVelocityReach_s = 0.005;

// Channels before any fit.

/// Sizes of the plays and frictions that an output may follow, as shares of the whole range of the input.
inline constexpr std::array kPlayShares{0.02, 0.3, 0.1};
/// Share of the variance of an unrelated output that is predicted by chance. Of noise over 20 s, fewer than one draw in
/// thirty exceeds it; where motion and noise have the same band, a twentieth wide, one in six.
inline constexpr double kUnrelatedShare = 0.1;
/// Share added to the diagonal where such shapes are almost multiples of each other.
inline constexpr double kShapeRidge = 1e-6;
/// Points to which signals are averaged where every lag is tried: their number squared is computed.
inline constexpr std::size_t kFarLagSamples = 1000;
/// Share of the energy that the fastest part of a signal has. Samples per cycle that it needs for derivatives (at ten,
/// a parabola is 3 % off), and to be seen at all: at four, every second sample is a reversal.
inline constexpr double kFastShare = 0.1;
inline constexpr double kSamplesPerCycle = 10.0;
inline constexpr double kSamplesPerCycleMin = 4.0;

/// Longest recording over which the hum of the mains is one sine: the frequency of a grid wanders by hundredths of a
/// hertz within minutes.
inline constexpr double kHumDurationMax_s = 120.0;

// Where: tables and plots of one interface.

/// A recording with fewer samples is too short to locate a gap in it.
inline constexpr std::size_t kLocaliseSamplesMin = 64;
/// Share of the energy in the listed windows, bands and regions together.
inline constexpr double kMainShare = 0.5;
/// Number of time windows of the list and of the plot, and of those to which parameters are fitted.
inline constexpr std::size_t kPlaceWindows = 24;
inline constexpr std::size_t kTimeWindows = 40;
inline constexpr std::size_t kParameterWindows = 16;
/// Bins of |displacement| and |velocity|, of the distance since a reversal, and of cycles at most.
inline constexpr std::size_t kMotionBins = 6;
inline constexpr std::size_t kReversalBins = 16;
inline constexpr std::size_t kCycleBinsMax = 16;
/// Segments of a spectrum: lengths, powers of two, and how many averages they leave where the signal allows.
inline constexpr std::size_t kSpectrumSegmentMin = 16;
inline constexpr std::size_t kSpectrumSegmentMax = 8192;
inline constexpr std::size_t kSpectrumAverages = 8;
/// Number of spectral lines in the first band; the spectrum does not resolve less.
inline constexpr double kFirstBandLines = 3.0;
/// A window whose amplitude is below this share of the largest is at rest; minimum number of windows for a drift.
inline constexpr double kWindowAmplitudeMin = 0.05;
inline constexpr std::size_t kDriftWindowsMin = 4;
/// Rank correlations are limited to this value, so that Fisher's z stays finite.
inline constexpr double kRankCorrelationMax = 0.999999;
/// Below this share of the force variance explained by displacement, a specimen is not treated as a spring.
inline constexpr double kElasticShareMin = 0.5;
/// Equal samples in a row at an extreme that count as clipped.
inline constexpr std::size_t kClippedRun = 3;
/// Longest lag that is searched, of a force behind its motion and of an actuator behind its command; minimum length of
/// the recording in such lags; minimum correlation.
inline constexpr double kForceLagMax_s = 0.05;
inline constexpr std::size_t kForceLagRecordings = 4;
inline constexpr double kForceLagCorrelationMin = 0.5;

// Repeatability.

/// Two recordings repeat each other when their inputs differ by less than this [rms over rms].
inline constexpr double kSameInput = 0.01;
/// A cycle repeats another one if their inputs agree within this share of half the range.
inline constexpr double kSameCycle = 0.02;
/// Cycles are counted between reversals of this many times the usual threshold; minimum number of cycles.
inline constexpr double kCycleThreshold = 10.0;
inline constexpr std::size_t kCycleReversalsMin = 5;
/// The period of cycles is searched within this share of the mean period.
inline constexpr double kCycleSpread = 0.03;

// The discrepancy term: what of a residual follows from the motion at all.

/// Velocity at which the direction of motion is half decided, over its root mean square.
inline constexpr double kDirectionWidth = 0.03;
/// Half-widths of the play operators, over the largest displacement.
inline constexpr std::array kPlayWidths{0.02, 0.05, 0.1, 0.2, 0.4, 0.7};
/// Knots over the range of displacement and of velocity, between which a force of them is linear.
inline constexpr std::size_t kMotionKnots = 12;
/// Earlier motion [averaged samples]: 4 ms to 0.26 s at the rate of the fit, each four times the one before.
inline constexpr std::array kLags_samples{1.0, 4.0, 16.0, 64.0};
/// Knots over the travelled path, between which what changes with it is linear.
inline constexpr std::size_t kPathKnots = 5;
/// A feature with a larger share of noise [rms over rms] is left out: it would predict the noise of the input.
inline constexpr double kFeatureNoiseMax = 0.1;
/// Penalties, over the number of samples; held-out cycles choose.
inline constexpr std::array kRidges{1e-7, 1e-5, 1e-3, 1e-2, 1e-1, 1.0};
/// An autocorrelation is summed over this many of its own integrated times (Sokal, 1997).
inline constexpr double kCorrelationTimes = 5.0;

// Traces: network faults and converter steps, found in the recorded values.

/// Longest delay of a target that is searched.
inline constexpr double kArrivalLagMax_s = 0.5;
/// If the lag of more than this share of moving samples is found, the targets are the ones that were sent.
inline constexpr double kLagsFoundMin = 0.9;
/// If a lag decreases in more than this share of steps, it fluctuates: a drift never decreases.
inline constexpr double kLagsShrinkingMin = 0.002;
/// Minimum share of new targets with equal lag when loss is the only fault.
inline constexpr double kEquallyLateMin = 0.97;
/// With fewer readings, no converter step is searched.
inline constexpr std::size_t kStepSamplesMin = 64;
/// Bins over the span of the readings, and over how many times that their spectrum goes: it resolves steps to a quarter
/// of what tells neighbouring ones apart.
inline constexpr std::ptrdiff_t kStepBins = std::ptrdiff_t{1} << 15;
inline constexpr std::ptrdiff_t kStepPadding = 4;
/// Steps in a span, at least, and per bin at most.
inline constexpr double kStepsInSpanMin = 6.0;
inline constexpr double kStepsPerBinMax = 0.25;
/// Steps are no finer than that multiple of the white noise: of a noise of half a step the coherence is 0.007.
inline constexpr double kStepOverNoise = 2.0;
/// Coherence of steps whose error, q / sqrt(12), is twice the noise behind the converter; with less it may as well be
/// an encoder's error that comes back with its pitch.
inline constexpr double kStepCoherenceMin = 0.66;
/// Multiple of the coherence that a signal without steps may have by its reversals.
inline constexpr double kStepOverChance = 4.0;
/// Of the coherence of the best step found, that of the coarser one that is meant.
inline constexpr double kStepAsCoherent = 0.8;
/// Golden section for the number of steps: how far from the spectrum's line, and how many times.
inline constexpr double kStepReach = 0.3;
inline constexpr int kStepSections = 24;

// Segments and their comparison.

/// Rate at which predictions are compared [Hz]. Ten samples per cycle of the fastest motion that
/// servo-hydraulic actuators follow (about 25 Hz).
inline constexpr double kFitRate_hz = 250.0;
/// Time before the recording during which everything is assumed at rest at the values of the first sample.
inline constexpr double kRestBefore_s = 0.5;
/// Substeps of the laws that integrate an equation: a search needs no more digits than a recording has.
inline constexpr double kLawSubsteps = 8.0;
/// What no function of the motion explains is taken for noise up to this share of the output [rms over rms]. A sensor
/// with more noise would be replaced before a test; more is the specimen's history.
inline constexpr double kNoiseShareMax = 0.05;
/// Energy that a fit leaves of blocks left out, over that of fitted ones, from which on its optional parameters are in
/// doubt: each parameter adds some percent with five blocks or more.
inline constexpr double kHeldOutBeyondFitted = 1.5;
/// Groups of samples among which the typical noise is looked for: six places, there and back.
inline constexpr std::size_t kNoiseGroups = 12;
/// Seed of the noise from which floors are computed.
inline constexpr std::uint64_t kNoiseSeed = 1;
/// Share of the signal that no model is expected to reproduce. It prevents rounding from deciding in recordings
/// without noise, and gives the weight of interfaces against each other.
inline constexpr double kModelAllowance = 0.0005;
/// Minimum and maximum number of held-out blocks per recording; the number of cycles decides.
inline constexpr double kBlocksMin = 5.0;
inline constexpr double kBlocksMax = 12.0;
/// A law is a spring when its force at these shares of the peak is proportional but for rounding. Share by which two
/// numbers differ at most that are the same, one of them written with other digits, as those of a ground motion.
inline constexpr std::array kSpringProbes{-1.0, -0.4, 0.3, 0.7};
inline constexpr double kRounding = 1e-9;

/// Friction coefficient of a slider that is told where the recordings tell the friction force only: of PTFE on steel
/// (Constantinou, Mokha and Reinhorn, 1990).
inline constexpr double kSliderFriction = 0.1;

// Search: its limits.

/// Number of steps for each searched parameter, three at least, of one effect and of several together, relative gain
/// below which the search stops, and number of starts that it continues. With twelve steps, a law of thirteen numbers
/// stopped on its way; with four for each, a clearance beside a friction.
inline constexpr std::array<int, 2> kStepsPerParameter{4, 8};
inline constexpr double kSearchTolerance = 1e-5;
inline constexpr std::size_t kRefinedStarts = 2;
/// Starts by the number of searched parameters: 0, 1, 2, 3 or more.
inline constexpr std::array<int, 4> kStarts{0, 7, 12, 18};
/// Ranges of positive values over more than this factor are searched in their logarithm.
inline constexpr double kLogarithmicFactor = 10.0;
/// Instants are looked for with so many times the starts, then by halving steps from and to these shares of the record.
inline constexpr int kInstantStarts = 6;
inline constexpr double kInstantStepMax = 1e-2;
inline constexpr double kInstantStepMin = 1e-5;
/// What a search resolves, as a share of a parameter's range, of a ratio or of a residual. Step of the numeric
/// derivatives: what the smoothest effects need is smaller, but a clearance or a friction has to move over several
/// samples to be felt. A parameter this near to a limit is at it, and a ratio this near to its fallback is left out.
/// Several effects are linear together when their prediction equals the sum of their columns to this share of the
/// residual.
inline constexpr double kResolution = 1e-3;
/// Shares added to the diagonal of normal equations: in the projection, where columns that are almost multiples of each
/// other would cancel in huge numbers, and in the covariance.
inline constexpr double kProjectionRidge = 1e-10;
inline constexpr double kCovarianceRidge = 1e-9;
/// Effects that are not linear together are linearised again at their present values, at most so many times; a step of
/// a fit without a block is halved as often. The step is in units of the parameter.
inline constexpr int kRelinearisations = 3;
inline constexpr double kCoefficientStep = 1e-2;

// Score of a candidate [nats].

/// Penalty of a candidate that also corrects slightly wrong parameters of the model [nats].
inline constexpr double kNuisanceCost = 3.0;
/// Largest error of a slightly wrong model, as a share of the secant stiffness.
inline constexpr double kSlightlyWrong = 0.25;
/// Advantage that an effect of a sensor needs over an effect of a stage with the same shape [nats].
/// More than a second parameter of the stage costs. What the data cannot tell apart is a set in any case.
inline constexpr double kSensorPrior = 6.0;
/// Advantage that an effect needs for each parameter that it has more than another effect [nats]. Of two effects that
/// do equally well on held-out data the simpler one is chosen. Half the logarithm of the independent samples of 30 s.
inline constexpr double kParameterPrior = 2.5;
/// Presliding over peak displacement above which an element is not dry friction, and the stiffness beside it, over that
/// of both, from which on the two are a specimen that yields and hardens: a hundredth is what a fit does not resolve.
inline constexpr double kPreslidingMax = 0.02;
inline constexpr double kHardeningMin = 0.01;
/// An effect that is worse than the best one by more than this on the coarse record is not fitted again and not
/// paired [nats].
inline constexpr double kFarBehind = 25.0;
/// Correlation of two changes of the prediction above which they are the same: what is left, a twentieth of the
/// amplitude, is within the error of any model.
inline constexpr double kSameSignature = 0.999;
/// Likewise of what they leave, as a share of its energy.
inline constexpr double kSameResidual = 0.1;
/// How many of the screened second effects are searched together with the first.
inline constexpr std::size_t kRefittedPairs = 5;

// What refutes an effect.

/// Shortest relaxation, over peak displacement over peak velocity: of a shorter one all but a twentieth of the force is
/// that of a dashpot, and the rest would only smooth the noise of the motion.
inline constexpr double kRelaxationOfSwing = 0.3;
/// Share of a limit over which a real one gives way. Readings may stay below a limit by as much, and pass one that was
/// fitted anywhere within it, without refuting it.
inline constexpr double kBeyondLimit = 0.05;
/// Height of a column over its largest drift, at least: with a drift of a tenth of its height, a column has collapsed.
inline constexpr double kHeightOverStroke = 10.0;

// Which effects are chosen.

/// Rate at which an effect is taken where there is nothing to explain, of all candidates together; see decisive_gain().
inline constexpr double kFalseAlarms = 0.05;
/// A further effect is accepted when it also leaves less than this share of the remaining gap in the median recording.
inline constexpr double kAnotherEffectLeaves = 0.6;
/// Share of the whole gap of that recording [variance] that it must explain, unless it is a wrong parameter of the
/// model.
inline constexpr double kAnotherEffectExplains = 0.03;
/// Or unless it leaves less than this share of the remaining gap.
inline constexpr double kSmallEffectLeaves = 0.25;
/// A wrong parameter of the model is chosen instead of the best further effect when it explains at least this share of
/// what that effect explains.
inline constexpr double kNumberInstead = 0.95;
/// Number of best single effects for which a second effect is searched, and largest number of effects chosen together.
inline constexpr std::size_t kLeadersPaired = 2;
inline constexpr std::size_t kEffectsMax = 4;

// Progress: shares of the time that the stages took on recordings of a laboratory. A wrong one only makes the display
// uneven.

/// End of the preparation, of the choice of effects and of the ranking, in the diagnosis of a degree of freedom.
inline constexpr double kPrepared = 0.02;
inline constexpr double kSelected = 0.95;
inline constexpr double kRanked = 0.99;
/// End of the fits of single effects and of pairs, in the choice of effects.
inline constexpr double kLibraryFitted = 0.1;
inline constexpr double kPairsFitted = 0.5;
/// End of the rounds that look for further effects.
inline constexpr double kEffectsChosen = 0.9;
/// End of the search of single effects, in their fits.
inline constexpr double kLibrarySearched = 0.8;
/// End of the screening and of the search, in a round that looks for a further effect.
inline constexpr double kPairsScreened = 0.1;
inline constexpr double kPairsSearched = 0.65;
/// End of the fits at the site, of the checks of the structure and of the simulated tests, in everything that
/// `hybridtest diagnose` does.
inline constexpr double kSiteDiagnosed = 0.9;
inline constexpr double kStructureDiagnosed = 0.92;
inline constexpr double kTestRerun = 0.98;
/// Silence after which a long fit repeats the last report: half of the two seconds that a display may stand still, as
/// one prediction of a long recording has to fit in between.
inline constexpr int kSilence_s = 1;

// Verdict.

/// A gap below this share of its floor [rms over rms] is none.
inline constexpr double kGapOverFloor = 0.3;
/// Residual over the floor [rms over rms] up to which nothing of a gap is left to explain, and a cause is named; above,
/// a gap that nothing reduces is unknown. When one gap is larger than that, gaps below it count as none.
inline constexpr double kNearFloor = 2.0;
/// A signal smaller than this multiple of its noise [standard deviations] cannot show a gap, so that an absent gap is
/// no evidence. At the larger multiple an effect of a tenth of the signal is as visible.
inline constexpr double kExcitedOverNoise = 3.0;
inline constexpr double kWellExcitedOverNoise = 30.0;
/// An interface is at fault when its residual exceeds its floor by this factor.
inline constexpr double kFaultOverFloor = 1.15;
/// Share of the repeatable gap [variance] up to which its cause is named in part.
inline constexpr double kPartialLeaves = 0.3;
/// Share of the gap [variance] that hardly matters: a tenth of its amplitude.
inline constexpr double kHardlyLeft = 0.01;
/// Share of the output [rms over rms] by which a number of the model is off [standard deviation]: load cells,
/// displacement transducers and measured stiffnesses are rarely known to better than a hundredth or two. The numbers of
/// an effect or a law are known no better, as its form is never quite that of the site.
inline constexpr double kNumbersWithin = 0.025;
/// A cause that changes a held-out prediction by less than this share of the floor does not act there. Example: a limit
/// that is not reached.
inline constexpr double kCauseActs = 0.1;
/// Probabilities are the softmax of the scores divided by this temperature. Fitted on development batches, in which the
/// first effect of a set was right more often than the scores alone predict.
inline constexpr double kTemperature = 0.5;
/// Probability that the cause is among the candidates at all: by Laplace's rule of succession, (right + 1) / (answers +
/// 2), from two blind batches that are opened (seeds 694127777 and 1893848761), in which 378 of 404 answers with a
/// cause were right, effects below the noise among them.
inline constexpr double kAnswerRight = 379.0 / 406.0;
/// A set holds the most probable effects until they are this probable together.
inline constexpr double kCredible = 0.9;
/// Entries of the ranking, causes included.
inline constexpr std::size_t kRankingMax = 8;

// Intervals.

/// Quantiles of the standard normal: 95 % two-sided, and one in a hundred two-sided for a drift.
inline constexpr double kTwoSided95 = 1.96;
inline constexpr double kTwoSided99 = 2.576;
/// Half of a parameter's interval over what its standard error gives: of rigs of this project with a misfit hidden
/// under the noise, the 95 % quantile of error over half (split conformal prediction; Lei et al., JASA 113, 2018). The
/// test IntervalCoverage.ScaleIsTheQuantileOfDrawnRigs computes it again.
inline constexpr double kIntervalScale = 1.36;
/// Share of what is known of a parameter that comes from other blocks, below which a block stands alone: an interval
/// from differences between blocks would be a thousand times too wide.
inline constexpr double kToldByOthers = 1e-3;
/// Draws of a bootstrap; one in forty lies beyond either end of a 95 % interval.
inline constexpr std::size_t kResamples = 200;
/// Blocks per segment that the shrinking is resampled from.
inline constexpr std::size_t kShrinkBlocks = 12;

// The computed structure: all signals are computed, without measurement noise.

/// As kHardlyLeft: wrong ratios come within a hundredth, right ones within rounding.
inline constexpr double kComputedLeaves = 1e-6;
/// Gauss-Newton on its ratios: steps, halvings of a step, step of the differences, change below which it is found.
inline constexpr int kRatioIterations = 12;
inline constexpr int kRatioHalvings = 8;
inline constexpr double kRatioDifference = 1e-6;
inline constexpr double kRatioSettled = 1e-12;
/// Network latency of a repeated simulated test: short compared with any step.
inline constexpr int kRerunLatency_us = 50;

}  // namespace hybridtest::tuning
