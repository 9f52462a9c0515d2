#include "diagnosis/localisation/sensor_checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/diagnosis/made_signals.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kSamples = 10'000;

TEST(CheckChannel, FindsQuantumAndClipping) {
  const auto whole = sampled(kSamples, [](double t) { return 1000.0 * sine(1.0, t); });
  auto spoiled = whole;
  for (double& value : spoiled) value = std::clamp(12.5 * std::round(value / 12.5), -800.0, 800.0);
  const ChannelCheck check = check_channel(spoiled);
  EXPECT_DOUBLE_EQ(check.quantum, 12.5);
  // |sin| is above 0.8 for 1 - 2/pi asin(0.8) of the time; half a quantum either way moves that by 1 %.
  EXPECT_NEAR(check.clipped_share, 1.0 - 2.0 / std::numbers::pi * std::asin(0.8), 0.01);
  EXPECT_GT(check.repeated_share, 0.4);
  EXPECT_EQ(check_channel(whole).clipped_share, 0.0);
  EXPECT_EQ(check_channel(std::vector<double>(10, 3.0)).quantum, 0.0);
}

TEST(ReadAtRest, FindsTareDriftAndNoise) {
  const auto motion = sampled(kSamples, [](double t) { return t > 2.0 && t < 8.0 ? 0.01 * sine(1.0, t) : 0.0; });
  auto force = white_noise(kSamples, 5.0, 1);
  for (std::size_t i = 0; i < kSamples; ++i)
    force[i] += 300.0 + 20.0 * static_cast<double>(i) * kMadePeriod_s + 1e6 * motion[i];
  const auto reading = read_at_rest(force, motion, kMadePeriod_s);
  ASSERT_TRUE(reading.has_value());
  // Means over 200 samples: 5/sqrt(200) = 0.35 N of noise, at 0.1 s and 9.9 s.
  EXPECT_NEAR(reading->first, 302.0, 1.1);
  EXPECT_NEAR(reading->last, 498.0, 1.1);
  EXPECT_NEAR(reading->drift_per_s, 20.0, 0.2);
  EXPECT_NEAR(reading->rms, 5.0, 0.35) << "and 4 N that the drift goes in a stretch, uniformly";
  EXPECT_FALSE(read_at_rest(force, sampled(kSamples, [](double t) { return sine(1.0, t); }), kMadePeriod_s));
}

TEST(ForceLag, EqualsSkewBetweenForceAndDisplacement) {
  const auto shape = [](double t) { return 0.01 * (sine(1.3, t) + sine(3.7, t) + 0.5 * sine(9.1, t)); };
  const auto motion = sampled(kSamples, shape);
  for (const double skew_s : {-0.0044, 0.0, 0.0123}) {
    const auto force = sampled(kSamples, [&](double t) { return 1e6 * shape(t - skew_s); });
    const auto lag = force_lag_s(motion, force, kMadePeriod_s);
    ASSERT_TRUE(lag.has_value());
    EXPECT_NEAR(*lag, skew_s, 2e-5) << "a parabola through three lags of 1 ms";
  }
  EXPECT_FALSE(force_lag_s(motion, white_noise(kSamples, 1.0, 1), kMadePeriod_s).has_value());
}

}  // namespace
}  // namespace hybridtest
