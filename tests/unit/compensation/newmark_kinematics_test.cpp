#include "compensation/newmark_kinematics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/config_error.hpp"
#include "tests/unit/compensation/frequency_response.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1e-3;

TEST(NewmarkKinematics, IsExactForConstantAcceleration) {
  const auto displacement_m = [](double t) { return 0.3 - 2.0 * t + 0.5 * 7.0 * t * t; };
  for (const double delay_s : {0.0, 0.4e-3, 20e-3, 0.5}) {
    for (const double step_s : {0.0, 0.01}) {
      NewmarkKinematics compensator{{delay_s, step_s}, kPeriod_s};
      for (int i = 0; i < 100; ++i) {
        const double t = kPeriod_s * i;
        CompensatorInput input;
        input.target_m = displacement_m(t);
        input.target_velocity_m_per_s = -2.0 + 7.0 * t;
        input.target_acceleration_m_per_s2 = 7.0;
        ASSERT_NEAR(compensator.command(input), displacement_m(t + step_s + delay_s), 2e-15);  // rounding
      }
    }
  }
}

TEST(NewmarkKinematics, IsTheIdentityAtZeroDelayAndStep) {
  NewmarkKinematics compensator{{0.0, 0.0}, kPeriod_s};
  EXPECT_EQ(compensator.command({0.123, 4.0, -500.0, 0.0, 0.0}), 0.123);
}

TEST(NewmarkKinematics, HasTheFrequencyResponseOfATaylorSeries) {
  for (const double delay_s : {5e-3, 20e-3}) {
    const auto closed_form = [&](double omega) {
      const double angle = omega * delay_s;
      return Complex{1.0 - 0.5 * angle * angle, angle};
    };
    // Rounding: 60 Hz and 20 ms make an angle of 7.5 and a response of 28.
    expect_frequency_response(
        [&] {
          return NewmarkKinematics{{delay_s, 0.0}, kPeriod_s};
        },
        closed_form, [](double) { return 2e-14; }, kPeriod_s, 0);
  }
}

TEST(NewmarkKinematics, FollowsAChangedDelayWithinItsBounds) {
  NewmarkKinematics compensator{{0.020, 0.0}, kPeriod_s};
  const CompensatorInput unit_velocity{0.0, 1.0, 0.0, 0.0, 0.0};
  compensator.set_delay(0.013);
  EXPECT_DOUBLE_EQ(compensator.command(unit_velocity), 0.013);
  compensator.set_delay(-1.0);
  EXPECT_EQ(compensator.command(unit_velocity), 0.0);
  compensator.set_delay(5.0);
  EXPECT_EQ(compensator.delay_s(), compensator.delay_s_max());
  compensator.set_delay(std::nan(""));
  EXPECT_EQ(compensator.delay_s(), compensator.delay_s_max());
  compensator.reset();
  EXPECT_DOUBLE_EQ(compensator.command(unit_velocity), 0.020);
}

TEST(NewmarkKinematics, RejectsParametersOutOfRangeAndSaysWhy) {
  EXPECT_THROW((NewmarkKinematics{{0.02, -1.0}, kPeriod_s}), ConfigError);
  EXPECT_THROW((NewmarkKinematics{{0.02, 0.0}, 0.0}), ConfigError);
  try {
    const NewmarkKinematics compensator{{1.5, 0.0}, kPeriod_s};
    FAIL() << "not refused";
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "delay_s is 1.5; expected 0 to 1, because acceleration is not constant for longer");
  }
}

}  // namespace
}  // namespace hybridtest
