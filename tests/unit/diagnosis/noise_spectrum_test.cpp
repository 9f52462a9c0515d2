#include "diagnosis/identification/noise_spectrum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/signals/signals.hpp"
#include "tests/unit/diagnosis/made_noise.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 0.004;
constexpr std::size_t kCount = 3000;

/// What the spectrum says over what the noise is, of 21 draws beside an output of 40 kN, smallest first. A gap of this
/// root mean square goes with the motion's slow part.
std::vector<double> ratios(const MadeNoise& kind, double gap_n) {
  std::vector<double> result;
  for (std::uint64_t draw = 0; draw < 21; ++draw) {
    std::vector<double> remainder = made_noise(kind, kCount, 200.0, kPeriod_s, draw);
    const double real = std::sqrt(mean_square(remainder));
    std::vector<double> measured(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
      const double t = kPeriod_s * static_cast<double>(i);
      remainder[i] += gap_n * std::numbers::sqrt2 * std::sin(4.0 * std::numbers::pi * t);
      measured[i] = kMadeStiffness_n_per_m * made_motion_m(t) + remainder[i];
    }
    result.push_back(noise_by_spectrum(measured, remainder, kPeriod_s).value_or(0.0) / real);
  }
  std::ranges::sort(result);
  return result;
}

// The quiet frequencies begin at some 10 Hz. Of noise whose corner lies below, at 4 Hz (0.9) and at 1 Hz (0.97), they
// show the slope and only by it the rest.
TEST(NoiseSpectrum, HoldsNoiseOfAnyColour) {
  for (const double hum : {0.0, 0.5}) {
    for (const double correlation : {0.0, 0.6}) {
      const std::vector<double> ratio = ratios({.correlation = correlation, .hum_share = hum}, 0.0);
      EXPECT_GT(ratio.front(), 0.9) << correlation << ", hum " << hum;
      EXPECT_LT(ratio.back(), 1.2) << correlation << ", hum " << hum;
    }
    for (const double correlation : {0.9, 0.97}) {
      const std::vector<double> ratio = ratios({.correlation = correlation, .hum_share = hum}, 0.0);
      EXPECT_GT(ratio.front(), 0.4) << correlation << ", hum " << hum;
      EXPECT_NEAR(ratio[10], 1.15, 0.25) << correlation << ", hum " << hum;
      EXPECT_LT(ratio.back(), 2.0) << correlation << ", hum " << hum;
    }
  }
}

TEST(NoiseSpectrum, LeavesOutAGapBelowTheQuietFrequencies) {
  const std::vector<double> alone = ratios({.correlation = 0.6}, 0.0);
  const std::vector<double> beside = ratios({.correlation = 0.6}, 600.0);  // three times the noise
  EXPECT_NEAR(beside.front(), alone.front(), 0.02);
  EXPECT_NEAR(beside.back(), alone.back(), 0.02);
}

TEST(NoiseSpectrum, SaysNothingWhereTheMotionFillsTheFrequencies) {
  const std::vector<double> noise = made_noise({}, kCount, 200.0, kPeriod_s, 1);
  const std::vector<double> motion = made_noise({}, kCount, 2.0e4, kPeriod_s, 2);
  EXPECT_EQ(noise_by_spectrum(motion, noise, kPeriod_s), std::nullopt);
}

}  // namespace
}  // namespace hybridtest
