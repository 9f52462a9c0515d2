#include "recording/summary/tracking_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace hybridtest {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Signals {
  std::vector<double> time_s, target_m, measured_m;
};

/// 2 Hz, 20 mm, measured 12.5 ms later; 10 whole seconds.
Signals delayed_sine(int samples = 10'000) {
  Signals signals;
  for (int i = 0; i < samples; ++i) {
    const double time_s = 0.001 * i;
    signals.time_s.push_back(5.0 + time_s);
    signals.target_m.push_back(0.02 * std::sin(4.0 * std::numbers::pi * time_s));
    signals.measured_m.push_back(0.02 * std::sin(4.0 * std::numbers::pi * (time_s - 0.0125)));
  }
  return signals;
}

TEST(TrackingError, DelayedSineMatchesClosedForm) {
  const Signals s = delayed_sine();
  const auto error = evaluate_tracking("floor_1", s.time_s, s.target_m, s.measured_m);
  ASSERT_TRUE(error.has_value());
  // sin a − sin b = 2 cos((a+b)/2) sin((a−b)/2): a sine of amplitude 2 A sin(ω τ / 2) over whole periods.
  const double amplitude_m = 2.0 * 0.02 * std::sin(2.0 * std::numbers::pi * 0.0125);
  EXPECT_EQ(error->dof, "floor_1");
  EXPECT_NEAR(error->rms_m, amplitude_m / std::numbers::sqrt2, 1e-12);
  EXPECT_NEAR(error->rms_relative.value(), amplitude_m / 0.02, 1e-10);
  // Of 500 samples a period, the one nearest to the peak is at most π / 500 off it.
  EXPECT_NEAR(error->peak_m, amplitude_m, (1.0 - std::cos(std::numbers::pi / 500.0)) * amplitude_m);
  EXPECT_NEAR(error->equivalent_delay_s.value(), 0.0125, 5e-7) << "as frequency_evaluation_test";
  EXPECT_NEAR(error->amplitude.value(), 1.0, 5e-6);
  EXPECT_NEAR(error->equivalent_frequency_hz.value(), 2.0, 4e-4);
  EXPECT_EQ(error->samples, 10'000U);
}

TEST(TrackingError, GapInRecordDoesNotDistortDelay) {
  Signals s = delayed_sine();
  for (auto* values : {&s.time_s, &s.target_m, &s.measured_m}) {
    values->erase(values->begin() + 1500, values->begin() + 1733);
  }
  s.measured_m[9000] = kNan;
  const auto error = evaluate_tracking("", s.time_s, s.target_m, s.measured_m);
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(error->samples, 9766U);
  EXPECT_NEAR(error->equivalent_delay_s.value(), 0.0125, 2e-6) << "7.5 s, where the taper is shorter";
}

TEST(TrackingError, AtRestHasErrorWithoutShareOrDelay) {
  const std::vector<double> time_s{0.0, 1.0, 2.0, 3.0};
  const std::vector<double> target_m(4, 0.0);
  const std::vector<double> measured_m{1e-3, -3e-3, 1e-3, 1e-3};
  const auto error = evaluate_tracking("", time_s, target_m, measured_m);
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(error->peak_m, 3e-3);
  EXPECT_NEAR(error->rms_m, std::sqrt(12e-6 / 4.0), 1e-15);
  EXPECT_FALSE(error->rms_relative.has_value());
  EXPECT_FALSE(error->equivalent_delay_s.has_value());
}

TEST(TrackingError, NoFinitePairGivesNone) {
  const std::vector<double> nothing{kNan, kNan};
  EXPECT_FALSE(evaluate_tracking("", nothing, nothing, nothing).has_value());
  EXPECT_FALSE(evaluate_tracking("", {}, {}, {}).has_value());
}

TEST(TrackingError, LongRecordHasTheSameDelay) {
  constexpr int kSamples = 5 * static_cast<int>(StretchEvaluation::kBlock) / 2;
  const Signals s = delayed_sine(kSamples);
  const auto error = evaluate_tracking("", s.time_s, s.target_m, s.measured_m);
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(error->samples, static_cast<std::size_t>(kSamples));
  EXPECT_NEAR(error->equivalent_delay_s.value(), 0.0125, 5e-7);
  EXPECT_NEAR(error->amplitude.value(), 1.0, 5e-6);
  EXPECT_NEAR(error->equivalent_frequency_hz.value(), 2.0, 4e-4);
}

TEST(TrackingError, LongestStretchCountsWhereItIsLong) {
  Signals s = delayed_sine(3 * static_cast<int>(StretchEvaluation::kBlock));
  // The first fifth, behind which samples are missing, has another delay.
  const std::size_t fifth = s.time_s.size() / 5;
  for (std::size_t i = 0; i < fifth; ++i) s.measured_m[i] = 0.5 * s.target_m[i];
  for (auto* values : {&s.time_s, &s.target_m, &s.measured_m}) {
    const auto gap = values->begin() + static_cast<std::ptrdiff_t>(fifth);
    values->erase(gap, gap + 100);
  }
  const auto error = evaluate_tracking("", s.time_s, s.target_m, s.measured_m);
  ASSERT_TRUE(error.has_value());
  EXPECT_NEAR(error->equivalent_delay_s.value(), 0.0125, 5e-7);
  EXPECT_NEAR(error->amplitude.value(), 1.0, 5e-6);
}

}  // namespace
}  // namespace hybridtest
