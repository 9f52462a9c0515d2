#include "compensation/inverse_compensation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/config_error.hpp"
#include "tests/unit/compensation/frequency_response.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 1024.0;

double command(InverseCompensation& compensator, double target_m) {
  return compensator.command({target_m, 0.0, 0.0, 0.0, 0.0});
}

TEST(InverseCompensation, IsExactForConstantVelocity) {
  InverseCompensation compensator{{13.3e-3}, kPeriod_s};
  EXPECT_EQ(command(compensator, 0.5), 0.5);  // nothing is known of the velocity yet
  for (int i = 1; i < 100; ++i) {
    const double t = kPeriod_s * i;
    ASSERT_NEAR(command(compensator, 0.5 - 2.0 * t), 0.5 - 2.0 * (t + 13.3e-3), 1e-14);  // rounding, 14 times
  }
}

TEST(InverseCompensation, IsTheIdentityAtZeroDelay) {
  InverseCompensation compensator{{0.0}, kPeriod_s};
  for (int i = 0; i < 50; ++i) {
    const double target_m = std::sin(0.7 * i * i);
    ASSERT_EQ(command(compensator, target_m), target_m);
  }
}

TEST(InverseCompensation, BringsItsActuatorModelToTheTargetExactly) {
  // x(k+1) = x(k) + (u(k+1) - x(k)) / alpha, as Chen and Ricles put it.
  const double alpha = 1.0 + 20e-3 / kPeriod_s;
  InverseCompensation compensator{{20e-3}, kPeriod_s};
  double displacement_m = 0.0;
  for (int i = 0; i < 300; ++i) {
    const double target_m = std::sin(0.03 * i) + 0.2 * std::sin(0.31 * i);
    displacement_m += (command(compensator, target_m) - displacement_m) / alpha;
    ASSERT_NEAR(displacement_m, target_m, 1e-14);  // rounding
  }
}

TEST(InverseCompensation, HasTheFrequencyResponseOfItsEquation) {
  const double alpha = 1.0 + 20e-3 / kPeriod_s;
  const auto closed_form = [&](double omega) { return alpha - (alpha - 1.0) * std::polar(1.0, -omega * kPeriod_s); };
  expect_frequency_response(
      [] {
        return InverseCompensation{{20e-3}, kPeriod_s};
      },
      closed_form, [](double) { return 1e-12; },  // rounding of phases up to 75 and of terms of 41
      kPeriod_s, 1);
}

TEST(InverseCompensation, AmplifiesAlternatingNoiseByItsNoiseGain) {
  InverseCompensation compensator{{20e-3}, kPeriod_s};
  EXPECT_DOUBLE_EQ(compensator.noise_gain(), 41.96);  // 2 alpha - 1, alpha = 21.48
  static_cast<void>(command(compensator, -1.0));
  EXPECT_DOUBLE_EQ(command(compensator, 1.0), compensator.noise_gain());
}

TEST(InverseCompensation, FollowsAChangedDelayWithinItsBounds) {
  InverseCompensation compensator{{20e-3}, kPeriod_s};
  static_cast<void>(command(compensator, 0.0));
  compensator.set_delay(5e-3);
  EXPECT_NEAR(command(compensator, kPeriod_s), kPeriod_s + 5e-3, 1e-17);
  compensator.set_delay(-5e-3);
  EXPECT_EQ(compensator.delay_s(), 0.0);
  compensator.set_delay(std::nan(""));
  EXPECT_EQ(compensator.delay_s(), 0.0);
  compensator.reset();
  EXPECT_EQ(compensator.delay_s(), 20e-3);
}

TEST(InverseCompensation, RejectsParametersOutOfRange) {
  EXPECT_THROW((InverseCompensation{{-1e-3}, kPeriod_s}), ConfigError);
  EXPECT_THROW((InverseCompensation{{1.1}, kPeriod_s}), ConfigError);
  EXPECT_THROW((InverseCompensation{{0.02}, 0.0}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
