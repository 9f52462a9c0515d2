#include "compensation/delay_estimators/recursive_least_squares.hpp"

#include <gtest/gtest.h>

#include "core/config_error.hpp"
#include "tests/unit/compensation/delayed_motion.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 1024.0;

TEST(RecursiveLeastSquares, EstimatesFractionalDelay) {
  // The straight line between samples is a weighted mean of two of them, late by the right part of a sample up to
  // (w T)^2 T / 16: below a microsecond.
  for (const double delay_s : {0.3 * kPeriod_s, 12.34e-3, 20e-3, 43.21e-3}) {
    RecursiveLeastSquares estimator{{}, kPeriod_s};
    EXPECT_NEAR(estimate_of(
                    estimator, [](double t) { return sine_m(3.0, t); }, delay_s, kPeriod_s, 15.0),
                delay_s, 1e-6);
  }
}

TEST(RecursiveLeastSquares, EstimatesDelayOfChirp) {
  RecursiveLeastSquares estimator{{}, kPeriod_s};
  EXPECT_NEAR(estimate_of(estimator, chirp_m, 17.77e-3, kPeriod_s, 20.0), 17.77e-3, 1e-6);
}

TEST(RecursiveLeastSquares, SeparatesGainAndDelay) {
  RecursiveLeastSquares estimator{{}, kPeriod_s};
  const auto motion = [](double t) { return sine_m(3.0, t); };
  EXPECT_NEAR(estimate_of(estimator, motion, 17.77e-3, kPeriod_s, 15.0, 0.7), 17.77e-3, 1e-6);
  EXPECT_NEAR(estimator.gain(), 0.7, 1e-4);
}

TEST(RecursiveLeastSquares, IsUnbiasedByNoise) {
  RecursiveLeastSquares estimator{{}, kPeriod_s};
  const double estimate_s = estimate_of(
      estimator, [](double t) { return sine_m(3.0, t); }, 17.77e-3, kPeriod_s, 15.0, 1.0, 16e-6);
  // A memory of 1024 samples counts for 2048: 16e-6 / (0.067 * 45) = 5.3 us. Three deviations.
  EXPECT_NEAR(estimate_s, 17.77e-3, 16e-6);
}

TEST(RecursiveLeastSquares, IgnoresSmallOrUncorrelatedMotion) {
  const auto motion = [](double t) { return sine_m(3.0, t); };
  RecursiveLeastSquares::Parameters parameters;
  parameters.motion_m_min = 4e-3;  // 5 mm are 3.5 in the root mean square
  RecursiveLeastSquares still{parameters, kPeriod_s};
  EXPECT_EQ(estimate_of(still, motion, 43e-3, kPeriod_s, 10.0), 20e-3);
  RecursiveLeastSquares unfollowed{{}, kPeriod_s};
  EXPECT_EQ(estimate_of(unfollowed, motion, 43e-3, kPeriod_s, 10.0, 0.1), 20e-3);
}

TEST(RecursiveLeastSquares, RejectsParametersOutOfRange) {
  EXPECT_THROW((RecursiveLeastSquares{{{}, 0.0, 1e-4}, kPeriod_s}), ConfigError);
  EXPECT_THROW((RecursiveLeastSquares{{{}, 1.0, 0.0}, kPeriod_s}), ConfigError);
  EXPECT_THROW((RecursiveLeastSquares{{{}, 1.0, 1e-4}, 0.0}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
