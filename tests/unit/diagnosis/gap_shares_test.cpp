#include "diagnosis/localisation/gap_shares.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <numeric>

#include "diagnosis/localisation/localise.hpp"
#include "diagnosis/signals/signals.hpp"
#include "tests/unit/diagnosis/made_signals.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kSamples = 10'000;

/// Between ±1, 1 s up and 1 s down, beginning at -1.
double triangle(double time_s) {
  const double phase = std::fmod(time_s, 2.0);
  return phase < 1.0 ? 2.0 * phase - 1.0 : 3.0 - 2.0 * phase;
}

TEST(Reversals, TriangleHasItsCorners) {
  const auto motion = sampled(kSamples, triangle);
  const auto turns = reversals_of(motion, reversal_threshold_m(motion));
  ASSERT_EQ(turns.size(), 9U) << "at 1 s, 2 s ... 9 s";
  for (std::size_t i = 0; i < turns.size(); ++i) {
    EXPECT_EQ(turns[i].sample, 1000 * (i + 1));
    EXPECT_NEAR(turns[i].displacement_m, i % 2 == 0 ? 1.0 : -1.0, 1e-12);
  }
  const auto distance = distance_since_reversal_m(motion, turns);
  EXPECT_NEAR(distance[500], 1.0, 1e-12) << "from the start";
  EXPECT_NEAR(distance[1000], 0.0, 1e-12);
  EXPECT_NEAR(distance[1250], 0.5, 1e-12);
  const auto cycles = cycles_completed(kSamples, turns);
  EXPECT_EQ(cycles[1999], 0.0);
  EXPECT_EQ(cycles[2000], 1.0);
  EXPECT_EQ(cycles[9999], 4.0);
}

TEST(Reversals, NoiseGivesNone) {
  auto motion = sampled(kSamples, triangle);
  const auto noise = white_noise(kSamples, 0.004, 3);
  for (std::size_t i = 0; i < kSamples; ++i) motion[i] += noise[i];
  EXPECT_EQ(reversals_of(motion, reversal_threshold_m(motion)).size(), 9U);
  EXPECT_GT(reversals_of(motion, 0.001).size(), 1000U) << "control: without a threshold it would be";
  EXPECT_TRUE(reversals_of({}, 0.1).empty());
}

TEST(GapOverTime, FindsTheAffectedStretch) {
  const std::vector<double> motion = sampled(kSamples, [](double t) { return sine(1.0, t); });
  std::vector<double> residual(kSamples, 0.0);
  for (std::size_t i = 4000; i < 6000; ++i) residual[i] = 0.5;
  const auto windows = gap_over_time({kMadePeriod_s, motion, motion, residual}, 10);
  ASSERT_EQ(windows.size(), 10U);
  EXPECT_DOUBLE_EQ(windows[4].share, 0.5);
  EXPECT_NEAR(windows[4].nrmse, 0.5 * std::sqrt(2.0), 1e-12);
  EXPECT_EQ(windows[3].share, 0.0);
  const auto main = windows_holding(windows, 0.9);
  ASSERT_EQ(main.size(), 1U);
  EXPECT_DOUBLE_EQ(main[0].begin_s, 4.0);
  EXPECT_DOUBLE_EQ(main[0].end_s, 6.0);
  EXPECT_DOUBLE_EQ(main[0].share, 1.0);
}

TEST(GapOverMotion, SeparatesLargeFromFastMotion) {
  const auto motion = sampled(kSamples, [](double t) { return sine(1.0, t); });
  std::vector<double> beyond(kSamples, 0.0);
  std::vector<double> inside(kSamples, 0.0);
  for (std::size_t i = 0; i < kSamples; ++i) {
    if (std::abs(motion[i]) > 0.8) beyond[i] = 1.0;
    if (std::abs(motion[i]) < 0.2) inside[i] = 1.0;
  }
  const MotionMap large = gap_over_motion({kMadePeriod_s, motion, motion, beyond}, 5, 5);
  EXPECT_NEAR(large.peak_m, 1.0, 1e-12);
  // Central differences over 2 x 5 ms take sin(w h)/(w h) of a velocity.
  EXPECT_NEAR(large.peak_m_per_s, 2.0 * std::numbers::pi * (1.0 - std::pow(2.0 * std::numbers::pi * 0.005, 2) / 6.0),
              1e-3);
  for (const GapRegion& region : regions_holding(large, 0.99)) {
    EXPECT_NEAR(region.displacement_low_m, 0.8, 1e-9);
    EXPECT_LT(region.velocity_low_m_per_s, 0.8 * large.peak_m_per_s) << "at the ends it is slow";
  }
  const MotionMap fast = gap_over_motion({kMadePeriod_s, motion, motion, inside}, 5, 5);
  const auto regions = regions_holding(fast, 0.99);
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].displacement_low_m, 0.0);
  EXPECT_NEAR(regions[0].velocity_low_m_per_s, 0.8 * fast.peak_m_per_s, 1e-9);
  // A sine spends 2/pi asin(0.2) of its time there.
  EXPECT_NEAR(regions[0].time_share, 2.0 / std::numbers::pi * std::asin(0.2), 0.003);
}

TEST(GapOver, BinRootMeanSquareIsThatOfItsSamples) {
  const auto motion = sampled(kSamples, triangle);
  const auto turns = reversals_of(motion, reversal_threshold_m(motion));
  const auto distance = distance_since_reversal_m(motion, turns);
  std::vector<double> residual(kSamples, 0.0);
  for (std::size_t i = 0; i < kSamples; ++i) residual[i] = distance[i] < 0.4995 ? 0.3 : 0.0;
  const auto bins = gap_over({kMadePeriod_s, motion, motion, residual}, distance, 4);
  ASSERT_EQ(bins.size(), 4U);
  EXPECT_NEAR(bins[0].high, 0.4995, 1e-12) << "the last sample before a turn is 1.998 away from the one before";
  EXPECT_NEAR(bins[0].nrmse, 0.3 * std::sqrt(3.0), 1e-3) << "a triangle's variance is 1/3";
  EXPECT_DOUBLE_EQ(bins[0].share, 1.0);
  EXPECT_EQ(bins[2].nrmse, 0.0);
  EXPECT_NEAR(static_cast<double>(bins[2].samples), 0.25 * kSamples, 10.0);
}

}  // namespace

namespace {

constexpr std::size_t kSpectrumSamples = 65'536;

TEST(Welch, DensityIntegratesToTheVariance) {
  const auto noise = white_noise(kSpectrumSamples, 3.0, 1);
  const Spectra spectra = welch(noise, noise, kMadePeriod_s, 1024);
  const double power = std::accumulate(spectra.output.begin(), spectra.output.end(), 0.0) * spectra.resolution_hz;
  // Relative standard error of a variance: sqrt(2/n) = 0.55 %, a little more for windows; three of them.
  EXPECT_NEAR(power, 9.0, 9.0 * 0.02);
  EXPECT_EQ(spectra.averages, 127U);
  EXPECT_NEAR(spectra.frequency_hz(spectra.output.size() - 1), 500.0, 1e-9);
}

TEST(Welch, CoherenceSeparatesInputFromNoise) {
  const auto input = white_noise(kSpectrumSamples, 1.0, 1);
  const auto alien = white_noise(kSpectrumSamples, 1.0, 2);
  std::vector<double> filtered(kSpectrumSamples, 0.0);
  for (std::size_t i = 1; i < kSpectrumSamples; ++i) filtered[i] = 2.0 * input[i] - 0.7 * input[i - 1];
  const Spectra linear = welch(input, filtered, kMadePeriod_s, 1024);
  const Spectra unrelated = welch(input, alien, kMadePeriod_s, 1024);
  double least = 1.0;
  double mean = 0.0;
  for (std::size_t i = 2; i + 2 < linear.input.size(); ++i) {
    least = std::min(least, linear.coherence(i));
    mean += unrelated.coherence(i) / static_cast<double>(linear.input.size() - 4);
  }
  EXPECT_GT(least, 0.99);
  // 1/n for independent segments; half overlap with Hann windows leaves 1/n (1 + 2/36).
  EXPECT_NEAR(mean, 1.0 / 127.0, 0.3 / 127.0);
}

TEST(GapOverFrequency, SharesAreThoseOfTheSines) {
  const auto input = sampled(kSpectrumSamples, [](double t) { return sine(1.5, t); });
  auto residual = sampled(kSpectrumSamples, [](double t) { return 1.0 * sine(1.5, t + 0.1) + 2.0 * sine(40.0, t); });
  const GapSignals signals{kMadePeriod_s, input, input, residual};
  const auto bands =
      gap_over_frequency(signals, welch(input, residual, kMadePeriod_s, welch_segment(kSpectrumSamples)));
  double sum = 0.0;
  for (const BandShare& band : bands) sum += band.share;
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_EQ(bands.front().low_hz, 0.0);
  EXPECT_NEAR(bands.back().high_hz, 500.0, 1e-9);

  const auto main = bands_holding(bands, 0.75);
  ASSERT_EQ(main.size(), 1U);
  EXPECT_LT(main[0].low_hz, 40.0);
  EXPECT_GT(main[0].high_hz, 40.0);
  // Powers 1/2 and 2: a fifth and four fifths, but for what the window leaks over a band's edge.
  EXPECT_NEAR(main[0].share, 0.8, 0.002);
  EXPECT_NEAR(main[0].nrmse, 2.0, 0.005) << "2/sqrt 2 over 1/sqrt 2";
  const auto both = bands_holding(bands, 0.99);
  ASSERT_GE(both.size(), 2U);
  EXPECT_NEAR(both[0].share, 0.2, 0.002);
  EXPECT_GT(both[0].coherence, 0.99) << "this part goes with the input";
}

TEST(WelchSegment, LeavesEightAverages) {
  for (const std::size_t samples : {100U, 1000U, 20'000U}) {
    const std::size_t segment = welch_segment(samples);
    const std::size_t averages = (samples - segment) / (segment / 2) + 1;
    EXPECT_GE(averages, 8U) << samples;
    EXPECT_LT(averages, 32U) << samples << ": no finer than that";
  }
}

}  // namespace

}  // namespace hybridtest
