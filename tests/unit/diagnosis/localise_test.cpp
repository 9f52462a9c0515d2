#include "diagnosis/localisation/localise.hpp"

#include <gtest/gtest.h>

#include "diagnosis/localisation/gap_shares.hpp"
#include "tests/unit/diagnosis/made_signals.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kSamples = 32'000;
constexpr double kStiffness_n_per_m = 2e6;
constexpr double kDamping_n_s_per_m = 3e4;

/// 1 Hz, its amplitude up and down again so that time and amplitude do not go together.
double swelling(double time_s) {
  return (0.01 + 0.04 * std::sin(std::numbers::pi * time_s / 32.0)) * sine(1.0, time_s);
}

GapSignals signals(const std::vector<double>& input, const std::vector<double>& output) {
  return {kMadePeriod_s, input, output, output};
}

TEST(ParametersOverTime, LinearSpecimenHasConstantParameters) {
  const auto motion = sampled(kSamples, swelling);
  const auto velocity = velocity_of(motion, kMadePeriod_s, tuning::kVelocityReach_s);
  std::vector<double> force(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) {
    force[i] = kStiffness_n_per_m * motion[i] + kDamping_n_s_per_m * velocity[i] - 400.0;
  }
  const auto windows = parameters_over_time(signals(motion, force), InterfaceKind::force_out, 16);
  ASSERT_EQ(windows.size(), 16U);
  for (const WindowParameters& window : windows) {
    EXPECT_NEAR(window.first, kStiffness_n_per_m, 1e-6 * kStiffness_n_per_m);
    EXPECT_NEAR(window.second, kDamping_n_s_per_m, 1e-6 * kDamping_n_s_per_m);
    EXPECT_NEAR(window.frequency_hz, 1.0, 0.01);
  }
}

TEST(ParameterDrift, WithAmplitudeIsANonlinearity) {
  const auto motion = sampled(kSamples, swelling);
  std::vector<double> force(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i)
    force[i] = kStiffness_n_per_m * motion[i] * (1.0 + 100.0 * motion[i] * motion[i]);
  const auto drifts =
      drift_of(parameters_over_time(signals(motion, force), InterfaceKind::force_out, 16), InterfaceKind::force_out);
  ASSERT_EQ(drifts.size(), 2U);
  EXPECT_EQ(drifts[0].parameter, "stiffness_n_per_m");
  EXPECT_TRUE(drifts[0].is_significant(drifts[0].with_amplitude)) << drifts[0].with_amplitude;
  EXPECT_GT(drifts[0].with_amplitude, 0.9);
  EXPECT_FALSE(drifts[0].is_significant(drifts[0].with_time)) << drifts[0].with_time;
}

TEST(ParameterDrift, WithTimeIsADegradation) {
  const auto motion = sampled(kSamples, swelling);
  std::vector<double> force(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) {
    force[i] = kStiffness_n_per_m * motion[i] * (1.0 - 0.01 * static_cast<double>(i) * kMadePeriod_s);
  }
  const auto drifts =
      drift_of(parameters_over_time(signals(motion, force), InterfaceKind::force_out, 16), InterfaceKind::force_out);
  EXPECT_LT(drifts[0].with_time, -0.99);
  EXPECT_TRUE(drifts[0].is_significant(drifts[0].with_time));
  EXPECT_FALSE(drifts[0].is_significant(drifts[0].with_amplitude)) << drifts[0].with_amplitude;
}

TEST(ParameterDrift, WithFrequencyIsAMissingDynamic) {
  // First-order lag of 20 ms, steady at each frequency: delay atan(w T)/w falls with frequency.
  constexpr double kLag_s = 0.02;
  std::vector<double> command(kSamples);
  std::vector<double> measured(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) {
    const std::size_t step = i / 2000;
    const double w = 2.0 * std::numbers::pi * (0.5 + 0.5 * static_cast<double>((7 * step) % 16));
    const double t = static_cast<double>(i) * kMadePeriod_s;
    command[i] = 0.01 * std::sin(w * t);
    measured[i] = 0.01 / std::sqrt(1.0 + w * w * kLag_s * kLag_s) * std::sin(w * t - std::atan(w * kLag_s));
  }
  const auto windows = parameters_over_time(signals(command, measured), InterfaceKind::displacement_out, 16);
  ASSERT_EQ(windows.size(), 16U);
  const double w_first = 2.0 * std::numbers::pi * 0.5;
  // 5 ms of the next stretch, eight times as fast, reach into the velocity of the last of 2000 samples.
  EXPECT_NEAR(windows[0].second, std::atan(w_first * kLag_s) / w_first, 5e-4);
  EXPECT_NEAR(windows[0].first, 1.0 / std::sqrt(1.0 + w_first * w_first * kLag_s * kLag_s), 1e-3);
  const auto drifts = drift_of(windows, InterfaceKind::displacement_out);
  EXPECT_EQ(drifts[1].parameter, "delay_s");
  EXPECT_LT(drifts[1].with_frequency, -0.99);
  EXPECT_TRUE(drifts[1].is_significant(drifts[1].with_frequency));
  EXPECT_FALSE(drifts[1].is_significant(drifts[1].with_time));
}

TEST(ParameterDrift, OfNoiseIsRarelySignificant) {
  int alarms = 0;
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto noise = white_noise(48, 1.0, static_cast<std::uint64_t>(trial));
    std::vector<WindowParameters> windows;
    for (std::size_t i = 0; i < 16; ++i) {
      windows.push_back({.begin_s = static_cast<double>(i),
                         .end_s = static_cast<double>(i) + 1.0,
                         .amplitude_m = std::exp(noise[i]),
                         .frequency_hz = std::exp(noise[16 + i]),
                         .first = noise[32 + i],
                         .second = 1.0});
    }
    const auto drifts = drift_of(windows, InterfaceKind::force_out);
    if (drifts[0].is_significant(drifts[0].with_amplitude)) ++alarms;
  }
  // One in a hundred expected; 12 of 300 is beyond one in a ten thousand of that binomial.
  EXPECT_LT(alarms, 12);
}

}  // namespace
}  // namespace hybridtest
