#include "compensation/force_correction_quadratic.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1e-3;

TEST(ForceCorrectionQuadratic, IsExactForQuadraticsInTime) {
  // Displacement and force are quadratics that are no function of each other; the measurement is late.
  const auto displacement_m = [](double t) { return 0.01 + 0.5 * t - 0.2 * t * t; };
  const auto force_n = [](double t) { return 300.0 - 2000.0 * t + 9000.0 * t * t; };
  for (const int points : {3, 7}) {
    for (const double lag_s : {0.0, 5.3e-3, 20e-3}) {
      ForceCorrectionQuadratic correction{{points, 0.010}, kPeriod_s};
      for (int i = 0; i < 200; ++i) {
        const double t = kPeriod_s * i;
        const double answer =
            correction.corrected_force({displacement_m(t), displacement_m(t - lag_s), force_n(t - lag_s)});
        if (i < 10 * points) continue;
        ASSERT_NEAR(answer, force_n(t), 1e-9);  // rounding of a quadratic through points 10 ms apart
      }
    }
  }
}

TEST(ForceCorrectionQuadratic, IsTheIdentityWithoutTrackingError) {
  ForceCorrectionQuadratic correction{{3, 0.010}, kPeriod_s};
  for (int i = 0; i < 100; ++i) {
    const double x = std::sin(0.05 * i);
    const double f = std::cos(0.03 * i);
    ASSERT_NEAR(correction.corrected_force({x, x, f}), f, 1e-13);  // rounding of the fits
  }
}

TEST(ForceCorrectionQuadratic, UsesUncorrectedForceForComplexRoots) {
  ForceCorrectionQuadratic correction{{3, 0.010}, kPeriod_s};
  double answer = 0.0;
  for (int i = 0; i <= 40; ++i) {
    const double t = kPeriod_s * (i - 40);
    answer = correction.corrected_force({0.1, -t * t, 5.0 + t});  // never as high as 0.1
  }
  EXPECT_EQ(answer, 5.0);
}

TEST(ForceCorrectionQuadratic, RejectsParametersOutOfRange) {
  EXPECT_THROW((ForceCorrectionQuadratic{{2, 0.01}, kPeriod_s}), ConfigError);
  EXPECT_THROW((ForceCorrectionQuadratic{{3, 0.0}, kPeriod_s}), ConfigError);
  EXPECT_THROW((ForceCorrectionQuadratic{{3, 1e-4}, kPeriod_s}), ConfigError);
  EXPECT_THROW((ForceCorrectionQuadratic{{101, 0.01}, kPeriod_s}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
