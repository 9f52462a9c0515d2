#include "compensation/linear_acceleration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/config_error.hpp"
#include "tests/unit/compensation/frequency_response.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 4096.0;

TEST(LinearAcceleration, IsExactForPolynomialsOfOrderThree) {
  const auto displacement_m = [](double t) { return 1.0 + 2.0 * t - 3.0 * t * t + 0.7 * t * t * t; };
  for (const double delay_s : {0.0, 0.1e-3, 13.3e-3, 24e-3}) {
    for (const double spacing_s : {0.0, 10e-3}) {
      LinearAcceleration compensator{{delay_s, spacing_s}, kPeriod_s};
      for (int i = 0; i < 500; ++i) {
        const double t = kPeriod_s * i;
        const double command_m =
            compensator.command({displacement_m(t), 2.0 - 6.0 * t + 2.1 * t * t, -6.0 + 4.2 * t, 0.0, 0.0});
        if (i < 100) continue;                                       // a spacing
        ASSERT_NEAR(command_m, displacement_m(t + delay_s), 2e-15);  // rounding
      }
    }
  }
}

TEST(LinearAcceleration, IsExactForConstantAccelerationFromTheFirstSample) {
  LinearAcceleration compensator{{20e-3, 0.0}, kPeriod_s};
  EXPECT_NEAR(compensator.command({0.1, 2.0, 30.0, 0.0, 0.0}), 0.1 + 2.0 * 20e-3 + 15.0 * 4e-4, 1e-16);
}

TEST(LinearAcceleration, IsTheIdentityAtZeroDelay) {
  LinearAcceleration compensator{{0.0, 0.0}, kPeriod_s};
  for (int i = 0; i < 50; ++i) {
    const double target_m = std::sin(0.7 * i * i);
    ASSERT_EQ(compensator.command({target_m, 3.0 * i, -5.0 * i * i, 0.0, 0.0}), target_m);
  }
}

TEST(LinearAcceleration, HasTheFrequencyResponseOfItsEquation) {
  static constexpr double kDelay_s = 82 * kPeriod_s;  // 20.02 ms, so that the points are exactly the delay apart
  const auto closed_form = [](double omega) {
    const Complex iw{0.0, omega};
    const Complex acceleration = iw * iw;
    const Complex predicted = acceleration * (2.0 - std::exp(-iw * kDelay_s));
    return 1.0 + kDelay_s * iw + kDelay_s * kDelay_s / 6.0 * (2.0 * acceleration + predicted);
  };
  // Rounding of responses up to 40.
  expect_frequency_response(
      [] {
        return LinearAcceleration{{kDelay_s, 0.0}, kPeriod_s};
      },
      closed_form, [](double) { return 1e-12; }, kPeriod_s, 82);
}

TEST(LinearAcceleration, KeepsSpacingWhenDelayChanges) {
  LinearAcceleration compensator{{20e-3, 0.0}, kPeriod_s};
  const double spacing_s = compensator.point_spacing_s();
  EXPECT_DOUBLE_EQ(spacing_s, 82 * kPeriod_s);
  const auto displacement_m = [](double t) { return t * t * t; };
  for (int i = 0; i < 300; ++i) {
    if (i == 200) compensator.set_delay(33e-3);
    const double t = kPeriod_s * i;
    const double command_m = compensator.command({displacement_m(t), 3.0 * t * t, 6.0 * t, 0.0, 0.0});
    if (i < 100) continue;                                                         // a spacing
    ASSERT_NEAR(command_m, displacement_m(t + (i < 200 ? 20e-3 : 33e-3)), 1e-16);  // rounding
  }
  compensator.set_delay(10.0);
  EXPECT_DOUBLE_EQ(compensator.delay_s(), 8.0 * spacing_s);
  compensator.reset();
  EXPECT_DOUBLE_EQ(compensator.delay_s(), 20e-3);
}

TEST(LinearAcceleration, RejectsParametersOutOfRange) {
  EXPECT_THROW((LinearAcceleration{{-1e-3, 0.0}, kPeriod_s}), ConfigError);
  EXPECT_THROW((LinearAcceleration{{2.0, 0.0}, kPeriod_s}), ConfigError);
  EXPECT_THROW((LinearAcceleration{{0.02, 0.002}, kPeriod_s}), ConfigError);  // ten spacings ahead
  EXPECT_THROW((LinearAcceleration{{0.02, -0.01}, kPeriod_s}), ConfigError);
  EXPECT_THROW((LinearAcceleration{{0.02, 0.0}, -1.0}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
