#include "compensation/adaptive_inverse.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "compensation/inverse_compensation.hpp"
#include "core/config_error.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 1024.0;

TEST(AdaptiveInverse, IsInverseCompensationWithoutGains) {
  AdaptiveInverse adaptive{{20e-3, 0.0, 0.0, 0.01}, kPeriod_s};
  InverseCompensation fixed{{20e-3}, kPeriod_s};
  for (int i = 0; i < 200; ++i) {
    CompensatorInput input;
    input.target_m = std::sin(0.02 * i);
    input.measured_displacement_m = std::cos(0.3 * i);
    ASSERT_EQ(adaptive.command(input), fixed.command(input));
  }
}

TEST(AdaptiveInverse, IsTheIdentityAtZeroDelayWithoutGains) {
  AdaptiveInverse compensator{{0.0, 0.0, 0.0, 0.01}, kPeriod_s};
  for (int i = 0; i < 50; ++i) {
    const double target_m = std::sin(0.7 * i * i);
    ASSERT_EQ(compensator.command({target_m, 0.0, 0.0, 1.0, 0.0}), target_m);
  }
}

/// The motion lags by `lag_s`; nothing that is commanded changes that.
double correction_after_one_cycle(double lag_s, double proportional, double integral) {
  AdaptiveInverse compensator{{20e-3, proportional, integral, 1.0}, kPeriod_s};
  const double omega = 2.0 * std::numbers::pi * 2.0;
  const double amplitude_m = 5e-3;
  const int samples = 512 + 2;  // a cycle of 2 Hz, and the measurement's sample of lateness
  for (int i = 0; i < samples; ++i) {
    CompensatorInput input;
    input.target_m = amplitude_m * std::sin(omega * kPeriod_s * i);
    input.measured_displacement_m = amplitude_m * std::sin(omega * (kPeriod_s * (i - 1) - lag_s));
    static_cast<void>(compensator.command(input));
  }
  return compensator.delay_s() - 20e-3;
}

TEST(AdaptiveInverse, IntegratesTheAreaBetweenTargetAndMeasurement) {
  // Over a cycle target and measurement, equal sines with a phase angle, draw an ellipse of area
  // pi A^2 sin(angle); the indicator is that area. Chords instead of arcs: (w T)^2 / 6 = 3e-5 smaller.
  const double omega = 2.0 * std::numbers::pi * 2.0;
  for (const double lag_s : {10e-3, -10e-3}) {
    const double area_m2 = std::numbers::pi * 25e-6 * std::sin(omega * lag_s);
    EXPECT_NEAR(correction_after_one_cycle(lag_s, 1e3, 0.0), kPeriod_s * 1e3 * area_m2,
                kPeriod_s * 1e3 * std::abs(area_m2) * 5e-5);
    // The area grows evenly: its integral over the cycle of half a second is half of it times that,
    // but for the sum's half sample.
    EXPECT_NEAR(correction_after_one_cycle(lag_s, 0.0, 1e3), kPeriod_s * 1e3 * area_m2 * 0.25,
                kPeriod_s * 1e3 * std::abs(area_m2) * 0.25 * 2.5e-3);
  }
}

TEST(AdaptiveInverse, FindsTheDelayOfItsActuatorModel) {
  // The actuator is the model of inverse compensation with 28 ms; the compensator starts from 20.
  const double alpha = 1.0 + 28e-3 / kPeriod_s;
  AdaptiveInverse compensator{{20e-3, 2e6, 1e6, 20e-3}, kPeriod_s};
  const double omega = 2.0 * std::numbers::pi * 2.0;
  double displacement_m = 0.0;
  double worst_m = 0.0;
  for (int i = 0; i < 60 * 1024; ++i) {
    CompensatorInput input;
    input.target_m = 5e-3 * std::sin(omega * kPeriod_s * i);
    input.measured_displacement_m = displacement_m;
    displacement_m += (compensator.command(input) - displacement_m) / alpha;
    if (i > 50 * 1024) worst_m = std::max(worst_m, std::abs(displacement_m - input.target_m));
  }
  // An indicator that has come to rest means no area between the two. Within a cycle it still moves.
  EXPECT_NEAR(compensator.delay_s(), 28e-3, 0.1e-3);
  EXPECT_LT(worst_m, 5e-3 * omega * 0.1e-3);
}

TEST(AdaptiveInverse, BoundsItsCorrection) {
  EXPECT_NEAR(correction_after_one_cycle(10e-3, 1e9, 0.0), 1.0, 1e-12);
  AdaptiveInverse compensator{{20e-3, 1e9, 0.0, 3e-3}, kPeriod_s};
  for (int i = 0; i < 2000; ++i) {
    static_cast<void>(compensator.command({std::sin(0.02 * i), 0.0, 0.0, std::sin(0.02 * i - 0.5), 0.0}));
    ASSERT_LE(std::abs(compensator.delay_s() - 20e-3), 3e-3 + 1e-15);
  }
}

TEST(AdaptiveInverse, RejectsParametersOutOfRange) {
  EXPECT_THROW((AdaptiveInverse{{-0.01, 1.0, 1.0, 0.01}, kPeriod_s}), ConfigError);
  EXPECT_THROW((AdaptiveInverse{{0.02, -1.0, 1.0, 0.01}, kPeriod_s}), ConfigError);
  EXPECT_THROW((AdaptiveInverse{{0.02, 1.0, -1.0, 0.01}, kPeriod_s}), ConfigError);
  EXPECT_THROW((AdaptiveInverse{{0.02, 1.0, 1.0, 2.0}, kPeriod_s}), ConfigError);
  EXPECT_THROW((AdaptiveInverse{{0.02, 1.0, 1.0, 0.01}, 0.0}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
