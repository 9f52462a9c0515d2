#include "experimental_site/closing_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/random.hpp"

namespace hybridtest {
namespace {

constexpr ClosingMotionSettings kSettings{
    .period_s = 1e-3, .halt_s = 0.02, .return_time_s = 0.2, .displacement_limit_m = 0.1, .velocity_limit_m_per_s = 0.5};

SiteVector one(double value) { return SiteVector::Constant(1, value); }

std::vector<double> path(ClosingMotion& motion, double from_m, double velocity_m_per_s, bool returns) {
  std::vector<double> path_m{from_m};
  motion.begin(one(from_m), one(velocity_m_per_s), returns);
  while (!motion.is_over()) {
    motion.advance();
    path_m.push_back(motion.displacement_m()[0]);
  }
  return path_m;
}

TEST(ClosingMotionTest, StopsHalfTheHaltTimeFurther) {
  ClosingMotion motion{kSettings, 1};
  const auto path_m = path(motion, 0.03, 0.2, false);
  ASSERT_EQ(path_m.size(), 21U);
  EXPECT_NEAR(path_m.back(), 0.03 + 0.5 * 0.02 * 0.2, 1e-15);
}

TEST(ClosingMotionTest, ReturnsToExactlyZero) {
  ClosingMotion motion{kSettings, 1};
  EXPECT_EQ(path(motion, 0.03, 0.0, true).size(), 1U + 200U) << "at once, in the time given";
  EXPECT_EQ(motion.displacement_m()[0], 0.0);
  EXPECT_EQ(path(motion, 0.0, 0.0, false).size(), 1U);
  ClosingMotionSettings quick = kSettings;
  quick.return_time_s = 0.0;
  ClosingMotion hurry{quick, 1};
  const auto periods = static_cast<std::size_t>(std::ceil(std::numbers::pi * 0.08 / 0.5 / 1e-3));
  EXPECT_EQ(path(hurry, -0.08, 0.0, true).size(), 1U + periods) << "T = pi a / v";
  EXPECT_EQ(path(hurry, 0.0, 0.0, true).size(), 2U);
}

TEST(ClosingMotionTest, KeepsVelocityContinuousAndWithinLimits) {
  Random random{11};
  for (int i = 0; i < 1000; ++i) {
    ClosingMotion motion{kSettings, 1};
    const double from_m = random.uniform(-0.1, 0.1);
    const double velocity = random.uniform(-0.5, 0.5);
    const auto path_m = path(motion, from_m, velocity, random.uniform() < 0.8);
    double before = velocity;
    for (std::size_t k = 1; k < path_m.size(); ++k) {
      const double now = (path_m[k] - path_m[k - 1]) / kSettings.period_s;
      ASSERT_LE(std::abs(path_m[k]), kSettings.displacement_limit_m);
      ASSERT_LE(std::abs(now), kSettings.velocity_limit_m_per_s * (1.0 + 1e-9));
      // Deceleration v / halt_s, and on the way back pi^2/2 of 0.1 m over the square of its duration,
      // which is 0.63 s there: 1.24 m/s2. Where the displacement limit cuts the halt short it may jump.
      const bool is_cut = std::abs(path_m[k]) == kSettings.displacement_limit_m;
      if (!is_cut && std::abs(path_m[k - 1]) != kSettings.displacement_limit_m) {
        ASSERT_LE(std::abs(now - before), (0.5 / 0.02 + 6.2) * kSettings.period_s * 1.01) << "period " << k;
      }
      before = now;
    }
  }
}

}  // namespace
}  // namespace hybridtest
