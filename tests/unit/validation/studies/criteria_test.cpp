#include "validation/studies/rths_benchmark/criteria.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace hybridtest::rths {
namespace {

constexpr double kPeriod_s = 1.0 / 4096.0;
constexpr double kOmega = 2.0 * std::numbers::pi * 2.0;  // 2 Hz
constexpr int kSamples = 4 * 4096;                       // whole cycles

/// amplitude sin(omega (t - delay)) + offset
std::vector<double> sine(double amplitude, double delay_s = 0.0, double offset = 0.0) {
  std::vector<double> values;
  for (int i = 0; i < kSamples; ++i)
    values.push_back(amplitude * std::sin(kOmega * (i * kPeriod_s - delay_s)) + offset);
  return values;
}

TEST(Criteria, StandardDeviationMatchesClosedForm) {
  // A / sqrt 2 over whole cycles; rounding only.
  EXPECT_NEAR(standard_deviation(sine(3.0, 0.0, 7.0)), 3.0 / std::sqrt(2.0), 1e-12);
  EXPECT_DOUBLE_EQ(largest_magnitude(std::vector{1.0, -4.0, 2.0}), 4.0);
}

TEST(Criteria, ErrorOfScaledSignalIsItsScale) {
  EXPECT_NEAR(deviation_error_percent(sine(1.1), sine(1.0)), 10.0, 1e-10);
  EXPECT_NEAR(peak_error_percent(sine(0.8), sine(1.0)), 20.0, 1e-10);
}

TEST(Criteria, ErrorOfDelayMatchesClosedForm) {
  for (const double delay_s : {0.001, 0.01, 0.04}) {
    EXPECT_NEAR(deviation_error_percent(sine(1.0, delay_s), sine(1.0)), 200.0 * std::sin(0.5 * kOmega * delay_s), 1e-9);
  }
}

TEST(Criteria, CorrelationFindsWholeSamplesUpToFortyNine) {
  for (const int lag : {0, 1, 7, 49}) {
    EXPECT_DOUBLE_EQ(correlation_lag_s(sine(1.0, lag * kPeriod_s), sine(1.0), kPeriod_s), lag * kPeriod_s) << lag;
  }
  EXPECT_DOUBLE_EQ(correlation_lag_s(sine(1.0, 80 * kPeriod_s), sine(1.0), kPeriod_s), 49 * kPeriod_s);
}

TEST(Criteria, LeadCountsAsZeroLag) {
  EXPECT_EQ(correlation_lag_s(sine(1.0, -10 * kPeriod_s), sine(1.0), kPeriod_s), 0.0);
}

TEST(Criteria, FittedDelayIsSignedAndFractional) {
  for (const double delay_s : {-2e-3, -1e-4, 1e-4, 2e-3}) {
    // Third order: sin x instead of x. The difference quotient adds (omega T)^2 / 6, the ends of the record a sample.
    const double angle = kOmega * delay_s;
    EXPECT_NEAR(fitted_delay_s(sine(1.0, delay_s), sine(1.0), kPeriod_s), delay_s,
                std::abs(delay_s) * (angle * angle / 6.0 + 1e-3));
  }
}

TEST(Criteria, EachUsesItsOwnSignals) {
  // Every signal is wrong by an amount of its own, so that no two can be mixed up.
  const auto target = sine(1.00);
  const auto measured = sine(1.05);
  const auto floor_2 = sine(2.2);
  const auto floor_3 = sine(3.9);
  const auto reference_1 = sine(1.25);
  const auto reference_2 = sine(2.0);
  const auto reference_3 = sine(3.0);
  const Criteria found =
      evaluate_criteria({target, measured, floor_2, floor_3}, {reference_1, reference_2, reference_3}, kPeriod_s);
  EXPECT_EQ(found.j(1), 0.0);
  EXPECT_NEAR(found.j(2), 5.0, 1e-9);
  EXPECT_NEAR(found.j(3), 5.0, 1e-9);
  EXPECT_NEAR(found.j(4), 16.0, 1e-9);
  EXPECT_NEAR(found.j(5), 16.0, 1e-9);
  EXPECT_NEAR(found.j(6), 10.0, 1e-9);
  EXPECT_NEAR(found.j(7), 30.0, 1e-9);
  EXPECT_NEAR(found.j(8), 10.0, 1e-9);
  EXPECT_NEAR(found.j(9), 30.0, 1e-9);
}

TEST(Criteria, IncompleteRunHasNoCriteria) {
  for (const double value : no_criteria().values) EXPECT_TRUE(std::isnan(value));
}

}  // namespace
}  // namespace hybridtest::rths
