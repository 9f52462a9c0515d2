#include "experimental_site/fading_offset.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace hybridtest {
namespace {

SiteVector one(double value) { return SiteVector::Constant(1, value); }

TEST(FadingOffsetTest, FadesToZeroWithReportedVelocity) {
  constexpr double kDuration_s = 0.5;
  constexpr double kInterval_s = 1e-4;
  FadingOffset offset{1};
  EXPECT_TRUE(offset.is_over());
  offset.begin(one(0.01), one(-0.3), kDuration_s);
  EXPECT_EQ(offset.displacement_m()[0], 0.01);
  EXPECT_EQ(offset.velocity_m_per_s()[0], -0.3);
  double before_m = 0.01;
  for (int i = 1; i < 5000; ++i) {
    const double begin_m_per_s = offset.velocity_m_per_s()[0];
    offset.advance(kInterval_s);
    ASSERT_FALSE(offset.is_over());
    // Trapezoid over a cubic: off by at most h^2/12 times the jerk, 12 d/T^3 + 6 v/T^2, a step.
    const double mean_m_per_s = 0.5 * (begin_m_per_s + offset.velocity_m_per_s()[0]);
    ASSERT_NEAR((offset.displacement_m()[0] - before_m) / kInterval_s, mean_m_per_s,
                kInterval_s * kInterval_s / 12.0 * (12.0 * 0.01 / 0.125 + 6.0 * 0.3 / 0.25) * 1.01);
    before_m = offset.displacement_m()[0];
  }
  EXPECT_NEAR(offset.displacement_m()[0], 0.0, 1e-7);
  EXPECT_NEAR(offset.velocity_m_per_s()[0], 0.0, 1e-3);
  offset.advance(kInterval_s);
  EXPECT_TRUE(offset.is_over());
  EXPECT_EQ(offset.displacement_m()[0], 0.0);
  EXPECT_EQ(offset.velocity_m_per_s()[0], 0.0);
}

TEST(FadingOffsetTest, ZeroOffsetEndsAtOnce) {
  FadingOffset offset{2};
  offset.begin(SiteVector::Zero(2), SiteVector::Zero(2), 1.0);
  EXPECT_TRUE(offset.is_over());
}

}  // namespace
}  // namespace hybridtest
