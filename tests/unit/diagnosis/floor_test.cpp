#include "diagnosis/localisation/floor.hpp"

#include <gtest/gtest.h>

#include "tests/unit/diagnosis/made_noise.hpp"
#include "tests/unit/diagnosis/made_signals.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kSamples = 20'000;
constexpr double kNoise = 40.0;
/// Three standard errors of a root mean square over 20 000 samples of white noise: 3/sqrt(2 n) = 1.5 %.
constexpr double kTolerance = 0.015 * kNoise;

/// A gap that comes back in every cycle, of 500, under noise that does not.
std::vector<double> repeatable_gap(const std::vector<double>& motion, std::uint64_t stream) {
  auto residual = white_noise(kSamples, kNoise, stream);
  for (std::size_t i = 0; i < kSamples; ++i) residual[i] += 500.0 * motion[i] * motion[i];
  return residual;
}

TEST(Floor, RepeatedCyclesGiveNoiseWithoutGap) {
  const auto motion = sampled(kSamples, [](double t) { return sine(1.0, t); });
  const auto residual = repeatable_gap(motion, 1);
  const auto floor = floor_of_cycles({kMadePeriod_s, motion, residual, residual});
  ASSERT_TRUE(floor.has_value());
  // Each of the 19 differences counts once more than it is independent.
  EXPECT_NEAR(floor->rms, kNoise, 1.5 * kTolerance);
  EXPECT_EQ(floor->source, FloorSource::repeated_cycles);
}

TEST(Floor, CycleFloorNeedsRepeatedCycles) {
  const auto sweep = sampled(kSamples, [](double t) { return std::sin(t * t); });
  EXPECT_FALSE(floor_of_cycles({kMadePeriod_s, sweep, sweep, sweep}).has_value());
  const auto growing = sampled(kSamples, [](double t) { return t * sine(1.0, t); });
  EXPECT_FALSE(floor_of_cycles({kMadePeriod_s, growing, growing, growing}).has_value());
}

TEST(Floor, RepeatedRecordingsGiveTheirNoise) {
  const auto motion = sampled(kSamples, [](double t) { return std::sin(t * t); });
  const auto first = repeatable_gap(motion, 1);
  const auto second = repeatable_gap(motion, 2);
  const auto floor =
      floor_of_repetition({kMadePeriod_s, motion, first, first}, {kMadePeriod_s, motion, second, second});
  ASSERT_TRUE(floor.has_value());
  EXPECT_NEAR(floor->rms, kNoise, kTolerance);
  const auto other = sampled(kSamples, [](double t) { return std::sin(1.1 * t * t); });
  EXPECT_FALSE(floor_of_repetition({kMadePeriod_s, motion, first, first}, {kMadePeriod_s, other, second, second}))
      << "not a repetition";
}

TEST(Floor, NoiseIsSeenWhereTheMotionTurnsSlowly) {
  const auto motion = sampled(kSamples, [](double t) { return sine(0.5, t); });
  const MadeNoise coloured{.correlation = 1.0 - kMadePeriod_s / 0.02};
  const auto noise = made_noise(coloured, kSamples, kNoise, kMadePeriod_s, 1);
  // A gap that is cubic in the displacement and a hundred times as large.
  std::vector<double> residual = noise;
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] += 100.0 * kNoise * std::pow(motion[i], 3);
  const auto still = noise_while_still({kMadePeriod_s, motion, residual, residual});
  ASSERT_TRUE(still.has_value());
  // In a stretch of 0.2 s five samples are independent, and mean and slope take two.
  EXPECT_NEAR(*still, kNoise, 0.4 * kNoise);
  const auto fast = sampled(kSamples, [](double t) { return sine(4.0, t); });
  EXPECT_FALSE(noise_while_still({kMadePeriod_s, fast, noise, noise}).has_value()) << "nowhere for 0.2 s";
}

TEST(Floor, EqualsNoiseAtRestAndHighFrequencies) {
  const auto motion = sampled(kSamples, [](double t) { return t > 8.0 && t < 12.0 ? sine(0.25, t - 8.0) : 0.0; });
  const auto residual = repeatable_gap(motion, 1);
  const GapSignals signals{kMadePeriod_s, motion, residual, residual};
  const auto rest = floor_at_rest(signals);
  ASSERT_TRUE(rest.has_value());
  EXPECT_NEAR(rest->rms, kNoise, 1.2 * kTolerance) << "over four fifths of the recording";
  // Second differences of white noise are correlated: 35/18 times the variance of independent ones.
  EXPECT_NEAR(floor_of_high_frequencies(signals).rms, kNoise, 1.5 * kTolerance);
  EXPECT_NEAR(repeatability_floor(signals).rms, kNoise, 1.5 * kTolerance);
  // Noise that takes 0.5 s to change; in stretches of 0.2 s two thirds of it would not show.
  const MadeNoise slow{.correlation = 1.0 - kMadePeriod_s / 0.5};
  const auto drifting = made_noise(slow, kSamples, kNoise, kMadePeriod_s, 1);
  // Its samples are independent 1 s apart, in 16 s: 3 / sqrt(2 * 16), and the mean is of them.
  EXPECT_NEAR(floor_at_rest({kMadePeriod_s, motion, drifting, drifting})->rms, kNoise, 0.5 * kNoise);
  const auto moving = sampled(kSamples, [](double t) { return sine(1.0, t); });
  EXPECT_FALSE(floor_at_rest({kMadePeriod_s, moving, residual, residual}).has_value());
}

}  // namespace
}  // namespace hybridtest
