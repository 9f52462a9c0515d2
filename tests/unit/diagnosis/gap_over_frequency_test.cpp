#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "diagnosis/localisation/band_shares.hpp"
#include "diagnosis/localisation/spectra.hpp"
#include "tests/unit/diagnosis/made_signals.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kSamples = 65'536;

TEST(Welch, DensityIntegratesToTheVariance) {
  const auto noise = white_noise(kSamples, 3.0, 1);
  const Spectra spectra = welch(noise, noise, kMadePeriod_s, 1024);
  const double power = std::accumulate(spectra.output.begin(), spectra.output.end(), 0.0) * spectra.resolution_hz;
  // Relative standard error of a variance: sqrt(2/n) = 0.55 %, a little more for windows; three of them.
  EXPECT_NEAR(power, 9.0, 9.0 * 0.02);
  EXPECT_EQ(spectra.averages, 127U);
  EXPECT_NEAR(spectra.frequency_hz(spectra.output.size() - 1), 500.0, 1e-9);
}

TEST(Welch, CoherenceSeparatesInputFromNoise) {
  const auto input = white_noise(kSamples, 1.0, 1);
  const auto alien = white_noise(kSamples, 1.0, 2);
  std::vector<double> filtered(kSamples, 0.0);
  for (std::size_t i = 1; i < kSamples; ++i) filtered[i] = 2.0 * input[i] - 0.7 * input[i - 1];
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
  const auto input = sampled(kSamples, [](double t) { return sine(1.5, t); });
  auto residual = sampled(kSamples, [](double t) { return 1.0 * sine(1.5, t + 0.1) + 2.0 * sine(40.0, t); });
  const GapSignals signals{kMadePeriod_s, input, input, residual};
  const auto bands = gap_over_frequency(signals, welch(input, residual, kMadePeriod_s, welch_segment(kSamples)));
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
