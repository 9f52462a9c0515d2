#include "plant/backward_differences.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 0.001;

/// The motion at the 100th sample of a displacement that depends on time.
template <class Displacement>
Motion motion_along(Displacement displacement_m, double period_s = kPeriod_s, int samples = 100) {
  BackwardDifferences differences{period_s};
  Motion motion;
  for (int i = 0; i <= samples; ++i) motion = differences.moved_to(displacement_m(period_s * i));
  return motion;
}

TEST(BackwardDifferences, AreExactForParabolaAndCubic) {
  const Motion parabola = motion_along([](double t) { return 0.01 + 0.2 * t - 3.0 * t * t; });
  EXPECT_NEAR(parabola.velocity_m_per_s, 0.2 - 6.0 * 0.1, 1e-11);  // rounding of 0.01 m over 1 ms
  const Motion cubic = motion_along([](double t) { return 5.0 * t * t * t; });
  EXPECT_NEAR(cubic.acceleration_m_per_s2, 30.0 * 0.1, 1e-8);
}

/// A first difference would be late: its error halves where these are a quarter.
TEST(BackwardDifferences, ErrorIsOfSecondOrder) {
  const auto sine = [](double t) { return std::sin(30.0 * t); };
  const auto error_of_velocity = [&](double period_s, int samples) {
    return motion_along(sine, period_s, samples).velocity_m_per_s - 30.0 * std::cos(3.0);
  };
  const auto error_of_acceleration = [&](double period_s, int samples) {
    return motion_along(sine, period_s, samples).acceleration_m_per_s2 + 900.0 * std::sin(3.0);
  };
  // The next order is smaller by 10 / 11 of the period times the ratio of the derivatives, which is 30 rad/s / tan(3)
  // for the acceleration: a tenth at 0.5 ms, half as much at 0.25 ms.
  EXPECT_NEAR(error_of_velocity(0.0005, 200) / error_of_velocity(0.00025, 400), 4.0, 0.1);
  EXPECT_NEAR(error_of_acceleration(0.0005, 200) / error_of_acceleration(0.00025, 400), 4.0, 0.3);
}

TEST(BackwardDifferences, BeginAgainAtRest) {
  BackwardDifferences differences{kPeriod_s};
  for (int i = 0; i < 5; ++i) (void)differences.moved_to(0.01 * i);
  differences.reset();
  const Motion motion = differences.moved_to(0.0);
  EXPECT_EQ(motion.velocity_m_per_s, 0.0);
  EXPECT_EQ(motion.acceleration_m_per_s2, 0.0);
}

}  // namespace
}  // namespace hybridtest
