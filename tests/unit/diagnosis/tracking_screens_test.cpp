#include "diagnosis/localisation/tracking_screens.hpp"

#include <gtest/gtest.h>

#include "tests/unit/diagnosis/made_signals.hpp"

namespace hybridtest {
namespace {

constexpr double kCommand_m = 0.02;
constexpr double kMeasured_m = 0.018;
constexpr double kPhase = 0.3;
constexpr std::size_t kPerCycle = 500;  // 2 Hz
constexpr std::size_t kCycles = 4;
constexpr double kStep = 2.0 * std::numbers::pi / kPerCycle;

std::vector<double> wave(double amplitude, double phase) {
  std::vector<double> values(kCycles * kPerCycle + 1);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = amplitude * std::sin(kStep * static_cast<double>(i) - phase);
  return values;
}

/// 1/2 (c[i-1] m[i] - c[i] m[i-1]) is 1/2 C M sin(phase) sin(step) at every sample of two sines.
TEST(TrackingIndicator, LaggingSineAddsItsPolygonArea) {
  const auto indicator = tracking_indicator_m2(wave(kCommand_m, 0.0), wave(kMeasured_m, kPhase));
  const double each = 0.5 * kCommand_m * kMeasured_m * std::sin(kPhase) * std::sin(kStep);
  for (std::size_t i = 0; i < indicator.size(); i += 100) {
    EXPECT_NEAR(indicator[i], static_cast<double>(i) * each, 1e-16);
  }
}

TEST(TrackingIndicator, DecreasesWhenMeasuredMotionLeads) {
  EXPECT_LT(tracking_indicator_m2(wave(kCommand_m, 0.0), wave(kMeasured_m, -kPhase)).back(), -1e-4);
  EXPECT_NEAR(tracking_indicator_m2(wave(kCommand_m, 0.0), wave(kMeasured_m, 0.0)).back(), 0.0, 1e-17);
}

/// Of an elastic specimen k the closed integral of f d(measured) vanishes; that of f d(command) is
/// -1/2 k C M sin(phase) sin(step) per sample, over 1/2 k C^2.
TEST(ErrorMonitor, LateElasticSpecimenGivesLoopEnergy) {
  constexpr double kStiffness_n_per_m = 3e6;
  auto measured = wave(kMeasured_m, kPhase);
  auto force = measured;
  for (double& value : force) value *= kStiffness_n_per_m;
  const auto monitor = error_monitor(wave(kCommand_m, 0.0), measured, force, kStiffness_n_per_m);
  const double expected =
      -static_cast<double>(kCycles * kPerCycle) * (kMeasured_m / kCommand_m) * std::sin(kPhase) * std::sin(kStep);
  EXPECT_NEAR(monitor.back(), expected, 1e-10);
}

TEST(DelayConsequence, IsMinusStiffnessTimesDelay) {
  constexpr double kDelay_s = 0.0125;
  constexpr double kStiffness_n_per_m = 4e6;
  const auto command = sampled(20'000, [](double t) { return 0.01 * sine(2.0, t); });
  const auto measured = sampled(20'000, [](double t) { return 0.01 * sine(2.0, t - kDelay_s); });
  auto force = measured;
  for (double& value : force) value = kStiffness_n_per_m * value + 700.0;
  const auto consequence = delay_consequence(command, measured, force, kMadePeriod_s);
  ASSERT_TRUE(consequence.has_value());
  // The index itself: see frequency_evaluation_test.
  EXPECT_NEAR(consequence->delay_s, kDelay_s, 5e-7);
  EXPECT_NEAR(consequence->stiffness_n_per_m, kStiffness_n_per_m, 1e-3);
  EXPECT_NEAR(consequence->equivalent_damping_n_s_per_m, -50e3, 2.0);
  EXPECT_NEAR(consequence->critical_delay_s(20e3), 0.005, 1e-9);
}

TEST(DelayConsequence, NeedsAStiffness) {
  const auto motion = sampled(1000, [](double t) { return sine(2.0, t); });
  EXPECT_FALSE(delay_consequence(motion, motion, std::vector<double>(1000, 5.0), kMadePeriod_s).has_value());
}

}  // namespace
}  // namespace hybridtest
