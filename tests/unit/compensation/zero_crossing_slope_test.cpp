#include "compensation/delay_estimators/zero_crossing_slope.hpp"

#include <gtest/gtest.h>

#include "core/config_error.hpp"
#include "tests/unit/compensation/delayed_motion.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 1024.0;

TEST(ZeroCrossingSlope, EstimatesFractionalDelay) {
  // Straight lines between samples: the sine's third derivative moves a crossing by less than (w T)^2 T / 16, below
  // a microsecond at 3 Hz.
  for (const double delay_s : {0.3 * kPeriod_s, 12.34e-3, 20e-3, 43.21e-3}) {
    ZeroCrossingSlope estimator{{}, kPeriod_s};
    EXPECT_NEAR(estimate_of(
                    estimator, [](double t) { return sine_m(3.0, t); }, delay_s, kPeriod_s, 10.0),
                delay_s, 1e-6);
  }
}

TEST(ZeroCrossingSlope, EstimatesDelayOfChirp) {
  ZeroCrossingSlope estimator{{}, kPeriod_s};
  EXPECT_NEAR(estimate_of(estimator, chirp_m, 17.77e-3, kPeriod_s, 20.0), 17.77e-3, 2e-6);  // 5 Hz at the end
}

TEST(ZeroCrossingSlope, IsIndependentOfGain) {
  ZeroCrossingSlope estimator{{}, kPeriod_s};
  const auto motion = [](double t) { return sine_m(3.0, t); };
  EXPECT_NEAR(estimate_of(estimator, motion, 17.77e-3, kPeriod_s, 10.0, 0.7), 17.77e-3, 1e-6);
}

TEST(ZeroCrossingSlope, AveragesNoise) {
  ZeroCrossingSlope estimator{{}, kPeriod_s};
  const double estimate_s = estimate_of(
      estimator, [](double t) { return sine_m(3.0, t); }, 17.77e-3, kPeriod_s, 10.0, 1.0, 16e-6);
  // Noise over slope and over the root of the window's four samples: 16e-6 / 0.094 / 2 = 85 us a crossing; a
  // crossing weight of 0.3 leaves sqrt(0.3 / 1.7) of it, 36 us. Three deviations.
  EXPECT_NEAR(estimate_s, 17.77e-3, 108e-6);
}

TEST(ZeroCrossingSlope, AveragesAnOffsetOfTheSensor) {
  ZeroCrossingSlope::Parameters parameters;
  parameters.crossing_weight = 0.05;
  ZeroCrossingSlope estimator{parameters, kPeriod_s};
  const auto motion = [](double t) { return sine_m(3.0, t); };
  double estimate_s = 0.0;
  for (int i = 0; i < 60 * 1024; ++i) {
    const double t = kPeriod_s * i;
    estimate_s = estimator.estimate({motion(t), motion(t - 17.77e-3) + 1e-4});
  }
  // 0.1 mm over 0.094 m/s makes crossings 1.06 ms early and late in turn; of that a weight of 0.05 leaves a
  // fortieth.
  EXPECT_NEAR(estimate_s, 17.77e-3, 1.07e-3 / 38.0);
}

TEST(ZeroCrossingSlope, IgnoresSlowCrossings) {
  ZeroCrossingSlope::Parameters parameters;
  parameters.slope_m_per_s_min = 0.1;  // 3 Hz and 5 mm cross with 0.094
  ZeroCrossingSlope estimator{parameters, kPeriod_s};
  EXPECT_EQ(estimate_of(
                estimator, [](double t) { return sine_m(3.0, t); }, 43e-3, kPeriod_s, 10.0),
            20e-3);
}

TEST(ZeroCrossingSlope, RejectsParametersOutOfRange) {
  const auto refuses = [](auto change) {
    ZeroCrossingSlope::Parameters parameters;
    change(parameters);
    EXPECT_THROW((ZeroCrossingSlope{parameters, kPeriod_s}), ConfigError);
  };
  refuses([](auto& p) { p.average_s = -1.0; });
  refuses([](auto& p) { p.slope_m_per_s_min = 0.0; });
  refuses([](auto& p) { p.motion_m_min = 0.0; });
  refuses([](auto& p) { p.crossing_weight = 0.0; });
  refuses([](auto& p) { p.crossing_weight = 1.1; });
}

}  // namespace
}  // namespace hybridtest
