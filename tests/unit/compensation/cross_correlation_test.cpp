#include "compensation/delay_estimators/cross_correlation.hpp"

#include <gtest/gtest.h>

#include "core/config_error.hpp"
#include "tests/unit/compensation/delayed_motion.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 1024.0;

// The likeness leans by what the window fades across the parabola: h^2 / (2 memory), h = 4 ms half its width. Of the
// part of a sample, at most half of one, the parabola, which stands for a cosine, misses (w h)^2 / 3.
constexpr double tolerance_s(double memory_s) { return 4e-3 * 4e-3 / (2.0 * memory_s) + 0.5 * kPeriod_s * 2e-3; }

TEST(CrossCorrelation, EstimatesFractionalDelay) {
  for (const double memory_s : {1.0, 4.0}) {
    for (const double delay_s : {0.3 * kPeriod_s, 12.34e-3, 20.0 * kPeriod_s, 43.21e-3}) {
      CrossCorrelation::Parameters parameters;
      parameters.memory_s = memory_s;
      CrossCorrelation estimator{parameters, kPeriod_s};
      const auto motion = [](double t) { return sine_m(3.0, t); };
      EXPECT_NEAR(estimate_of(estimator, motion, delay_s, kPeriod_s, 30.0), delay_s, tolerance_s(memory_s));
    }
  }
}

TEST(CrossCorrelation, EstimatesDelayOfChirp) {
  CrossCorrelation estimator{{}, kPeriod_s};
  EXPECT_NEAR(estimate_of(estimator, chirp_m, 17.77e-3, kPeriod_s, 20.0), 17.77e-3, tolerance_s(1.0));
}

TEST(CrossCorrelation, IsIndependentOfGain) {
  CrossCorrelation estimator{{}, kPeriod_s};
  const auto motion = [](double t) { return sine_m(3.0, t); };
  EXPECT_NEAR(estimate_of(estimator, motion, 17.77e-3, kPeriod_s, 10.0, 0.7), 17.77e-3, tolerance_s(1.0));
}

TEST(CrossCorrelation, AveragesNoise) {
  CrossCorrelation estimator{{}, kPeriod_s};
  const double estimate_s = estimate_of(
      estimator, [](double t) { return sine_m(3.0, t); }, 17.77e-3, kPeriod_s, 10.0, 1.0, 16e-6);
  // No estimate from 1024 effective samples tells better than noise / (rms velocity sqrt(1024)) = 16e-6 /
  // (0.067 * 32) = 7.5 us; three deviations, and what the window leaves without noise.
  EXPECT_NEAR(estimate_s, 17.77e-3, 23e-6 + tolerance_s(1.0));
}

TEST(CrossCorrelation, DoesNotUpdateBelowMinimumMotion) {
  CrossCorrelation::Parameters parameters;
  parameters.motion_m_min = 4e-3;  // 5 mm are 3.5 in the root mean square
  CrossCorrelation estimator{parameters, kPeriod_s};
  EXPECT_EQ(estimate_of(
                estimator, [](double t) { return sine_m(3.0, t); }, 43e-3, kPeriod_s, 10.0),
            20e-3);
}

TEST(CrossCorrelation, RejectsParametersOutOfRange) {
  const auto refuses = [](auto change) {
    CrossCorrelation::Parameters parameters;
    change(parameters);
    EXPECT_THROW((CrossCorrelation{parameters, kPeriod_s}), ConfigError);
  };
  refuses([](auto& p) { p.memory_s = 0.0; });
  refuses([](auto& p) { p.parabola_half_s = 1e-4; });
  refuses([](auto& p) { p.comparison_period_s = 0.0; });
  refuses([](auto& p) { p.motion_m_min = 0.0; });
}

}  // namespace
}  // namespace hybridtest
