#include "compensation/adaptive_time_series.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "compensation/conditional_adaptive_time_series.hpp"
#include "core/config_error.hpp"
#include "core/random.hpp"
#include "tests/unit/compensation/frequency_response.hpp"
#include "tests/unit/compensation/second_order_actuator.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 2048.0;
constexpr double kA1_s = 0.016;
constexpr double kA2_s2 = 1.1e-4;

CompensatorInput target(double time_s, double amplitude_m) {
  CompensatorInput input;
  for (const double frequency_hz : {1.1, 3.7, 6.3}) {
    const double omega = 2.0 * std::numbers::pi * frequency_hz;
    input.target_m += amplitude_m * std::sin(omega * time_s);
    input.target_velocity_m_per_s += amplitude_m * omega * std::cos(omega * time_s);
    input.target_acceleration_m_per_s2 -= amplitude_m * omega * omega * std::sin(omega * time_s);
  }
  return input;
}

struct Outcome {
  Eigen::Vector3d coefficients;
  double worst_error_m = 0.0;  // of the last two seconds
  Eigen::Vector3d largest_step = Eigen::Vector3d::Zero();
  Eigen::Vector3d smallest, largest;
};

template <class Series>
Outcome track(Series& series, SecondOrderActuator actuator, double amplitude_m, double noise_m = 0.0) {
  Outcome outcome;
  outcome.smallest = outcome.largest = series.coefficients();
  Random random{3};
  double measured_m = 0.0;
  constexpr int kSamples = 8 * 2048;
  for (int i = 0; i < kSamples; ++i) {
    CompensatorInput input = target(kPeriod_s * i, amplitude_m);
    if (i > kSamples - 2 * 2048) {
      outcome.worst_error_m = std::max(outcome.worst_error_m, std::abs(actuator.displacement_m - input.target_m));
    }
    input.measured_displacement_m = measured_m;  // a sample old
    measured_m = actuator.displacement_m + noise_m * random.normal();
    const Eigen::Vector3d before = series.coefficients();
    actuator.advance(series.command(input), kPeriod_s);
    outcome.largest_step = outcome.largest_step.cwiseMax((series.coefficients() - before).cwiseAbs());
    outcome.smallest = outcome.smallest.cwiseMin(series.coefficients());
    outcome.largest = outcome.largest.cwiseMax(series.coefficients());
  }
  outcome.coefficients = series.coefficients();
  return outcome;
}

template <class Series>
class TimeSeries : public testing::Test {};
using Both = testing::Types<AdaptiveTimeSeries, ConditionalAdaptiveTimeSeries>;
TYPED_TEST_SUITE(TimeSeries, Both);

TYPED_TEST(TimeSeries, FindsTheCoefficientsOfItsActuator) {
  TypeParam series{{}, kPeriod_s};
  const Outcome outcome = track(series, {1.02, kA1_s, kA2_s2}, 3e-3);
  // The measurement is compared with the command of its own instant, and that acts half a period later: a1 is
  // larger by a0 T/2. Backward differences are late by T/2 for x' and T for x'': a2 is larger by a1 T and a1
  // changes by a2 w^2 T, w the motion's 20 to 40 per second.
  EXPECT_NEAR(outcome.coefficients(0), 1.02, 0.002);
  EXPECT_NEAR(outcome.coefficients(1), kA1_s, 1.5 * kPeriod_s);
  EXPECT_NEAR(outcome.coefficients(2), kA2_s2, 1.5 * kA1_s * kPeriod_s);
  // Of the sum of three amplitudes; without adaptation it is 30 %.
  EXPECT_LT(outcome.worst_error_m, 0.01 * 9e-3);
}

TYPED_TEST(TimeSeries, StaysUsefulWithSensorNoise) {
  TypeParam series{{}, kPeriod_s};
  const Outcome outcome = track(series, {1.02, kA1_s, kA2_s2}, 3e-3, 16e-6);
  EXPECT_NEAR(outcome.coefficients(0), 1.02, 0.01);
  EXPECT_LT(outcome.worst_error_m, 0.02 * 9e-3);
}

TYPED_TEST(TimeSeries, KeepsPublishedRangesAndRates) {
  TypeParam series{{}, kPeriod_s};
  // An actuator outside the ranges: a0 would be 1.6.
  const Outcome outcome = track(series, {1.6, 0.05, 4e-4}, 3e-3);
  EXPECT_LE(outcome.largest(0), 1.3);
  EXPECT_GE(outcome.smallest(0), 0.7);
  EXPECT_LE(outcome.largest(1), 0.08);
  EXPECT_GE(outcome.smallest(1), 0.0);
  EXPECT_LE(outcome.largest(2), 0.0032);
  EXPECT_GE(outcome.smallest(2), 0.0);
  const Eigen::Vector3d rate = outcome.largest_step / kPeriod_s;
  EXPECT_LE(rate(0), 2.0 * (1.0 + 1e-9));
  EXPECT_LE(rate(1), 0.05 * (1.0 + 1e-9));
  EXPECT_LE(rate(2), 0.001 * (1.0 + 1e-9));
  EXPECT_GT(rate(1), 0.049);  // it did hurry
}

TYPED_TEST(TimeSeries, DoesNotUpdateBelowMinimumMotion) {
  TypeParam series{{}, kPeriod_s};
  const Outcome outcome = track(series, {1.02, kA1_s, kA2_s2}, 3e-5, 16e-6);
  EXPECT_EQ(outcome.coefficients, Eigen::Vector3d(1.0, 0.020, 0.0002));
}

TYPED_TEST(TimeSeries, InitialFrequencyResponseMatchesTimeSeries) {
  TimeSeriesParameters parameters;
  parameters.a0 = 1.1;
  parameters.a1_s = 0.02;
  parameters.a2_s2 = 3e-4;
  const auto closed_form = [](double omega) { return Complex{1.1 - 3e-4 * omega * omega, 0.02 * omega}; };
  expect_frequency_response(
      [&] {
        return TypeParam{parameters, kPeriod_s};
      },
      closed_form, [](double) { return 1e-13; },  // rounding of terms up to 43
      kPeriod_s, 0);
}

TYPED_TEST(TimeSeries, IsTheIdentityWithoutDerivatives) {
  TimeSeriesParameters parameters;
  parameters.a1_s = parameters.a2_s2 = 0.0;
  TypeParam series{parameters, kPeriod_s};
  for (int i = 0; i < 1000; ++i) {
    const double target_m = std::sin(0.7 * i * i);
    ASSERT_EQ(series.command({target_m, 2.0, -3.0, 0.1, 0.0}), target_m);
  }
}

TYPED_TEST(TimeSeries, RejectsParametersOutOfRangeAndSaysWhy) {
  const auto refused = [](auto change) {
    TimeSeriesParameters parameters;
    change(parameters);
    try {
      const TypeParam series{parameters, kPeriod_s};
    } catch (const ConfigError& error) {
      return std::string{error.what()};
    }
    return std::string{};
  };
  EXPECT_EQ(refused([](TimeSeriesParameters&) {}), "");
  EXPECT_EQ(refused([](TimeSeriesParameters& p) { p.a1_s = 0.09; }),
            "a1_s is 0.09; expected 0 to 0.08, because the coefficient starts inside its own range");
  EXPECT_NE(refused([](TimeSeriesParameters& p) { p.a0_min = 1.4; }), "");
  EXPECT_NE(refused([](TimeSeriesParameters& p) { p.window_s = 0.01; }), "");
  EXPECT_NE(refused([](TimeSeriesParameters& p) { p.filter_hz = 1000.0; }), "");
  EXPECT_NE(refused([](TimeSeriesParameters& p) { p.motion_m_min = 0.0; }), "");
  EXPECT_NE(refused([](TimeSeriesParameters& p) { p.a0_rate_max = -1.0; }), "");
  EXPECT_NE(refused([](TimeSeriesParameters& p) { p.a2_s2 = std::nan(""); }), "");
}

TEST(AdaptiveTimeSeries, ForgetsMotionOlderThanItsWindow) {
  // An actuator that changes: after a window and the time that the rates take, the new one is known.
  AdaptiveTimeSeries series{{}, kPeriod_s};
  SecondOrderActuator actuator{1.0, 0.012, 1.0e-4};
  double measured_m = 0.0;
  for (int i = 0; i < 10 * 2048; ++i) {
    if (i == 5 * 2048) actuator.a0 = 1.1;
    CompensatorInput input = target(kPeriod_s * i, 3e-3);
    input.measured_displacement_m = measured_m;
    measured_m = actuator.displacement_m;
    actuator.advance(series.command(input), kPeriod_s);
    if (i == 5 * 2048 - 1) {
      EXPECT_NEAR(series.coefficients()(0), 1.0, 0.002);
    }
    if (i == 5 * 2048 + 3 * 2048) {
      EXPECT_NEAR(series.coefficients()(0), 1.1, 0.002);
    }
  }
}

TEST(AdaptiveTimeSeries, ForgetsRoundingErrorsOfLargeMotion) {
  // Ten million times as large, so that what rounding leaves of its squares is a hundredth of those that follow.
  AdaptiveTimeSeries series{{}, kPeriod_s};
  SecondOrderActuator actuator{1.02, kA1_s, kA2_s2};
  double measured_m = 0.0;
  for (int i = 0; i < 8 * 2048; ++i) {
    CompensatorInput input = target(kPeriod_s * i, i < 3 * 2048 ? 3e4 : 3e-3);
    input.measured_displacement_m = measured_m;
    measured_m = actuator.displacement_m;
    actuator.advance(series.command(input), kPeriod_s);
  }
  EXPECT_NEAR(series.coefficients()(0), 1.02, 0.002);
  EXPECT_NEAR(series.coefficients()(1), kA1_s, 1.5 * kPeriod_s);
  EXPECT_NEAR(series.coefficients()(2), kA2_s2, 1.5 * kA1_s * kPeriod_s);
}

}  // namespace
}  // namespace hybridtest
