#include "validation/design_motion/elastic_spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace hybridtest::design_motion {
namespace {

const ElasticSpectrum kSpectrum = ElasticSpectrum::type_1_ground_c(1.0);

TEST(ElasticSpectrum, HasTheOrdinatesOfTheCode) {
  EXPECT_DOUBLE_EQ(kSpectrum.zero_period_m_per_s2(), 1.15);
  EXPECT_DOUBLE_EQ(kSpectrum.at(0.1), 1.15 * 1.75);
  EXPECT_DOUBLE_EQ(kSpectrum.at(0.2), 1.15 * 2.5);
  EXPECT_DOUBLE_EQ(kSpectrum.at(0.4), 1.15 * 2.5);
  EXPECT_DOUBLE_EQ(kSpectrum.at(0.6), 1.15 * 2.5);
  EXPECT_DOUBLE_EQ(kSpectrum.at(1.2), 1.15 * 2.5 / 2.0);
  EXPECT_DOUBLE_EQ(kSpectrum.at(2.0), 1.15 * 2.5 * 0.3);
  EXPECT_DOUBLE_EQ(kSpectrum.at(4.0), 1.15 * 2.5 * 1.2 / 16.0);
  EXPECT_DOUBLE_EQ(kSpectrum.ground_displacement_m(), 0.025 * 1.15 * 0.6 * 2.0);
}

TEST(ElasticSpectrum, IsContinuous) {
  // At T_E and T_F the code's own constants meet to (2 pi)^2 * 0.025 = 0.987.
  for (const double corner_s : {0.2, 0.6, 2.0, 10.0}) {
    EXPECT_NEAR(kSpectrum.at(corner_s * (1.0 - 1e-12)) / kSpectrum.at(corner_s * (1.0 + 1e-12)), 1.0, 1e-10);
  }
  EXPECT_NEAR(kSpectrum.at(6.0 * (1.0 + 1e-12)) / kSpectrum.at(6.0), 0.987, 0.001);
}

TEST(ElasticSpectrum, TendsToGroundDisplacement) {
  const double omega = 2.0 * std::numbers::pi / 12.0;
  EXPECT_NEAR(kSpectrum.at(12.0), omega * omega * kSpectrum.ground_displacement_m(), 1e-15);
}

TEST(ElasticSpectrum, DecreasesWithDampingToALimit) {
  ElasticSpectrum damped = kSpectrum;
  damped.damping_ratio = 0.10;
  EXPECT_DOUBLE_EQ(damped.at(0.4), 1.15 * 2.5 * std::sqrt(10.0 / 15.0));
  EXPECT_DOUBLE_EQ(damped.zero_period_m_per_s2(), 1.15);
  damped.damping_ratio = 0.60;
  EXPECT_DOUBLE_EQ(damped.at(0.4), 1.15 * 2.5 * 0.55);
}

TEST(LogarithmicPeriods, AreSpacedByOneFactor) {
  const auto periods = logarithmic_periods(0.05, 4.0, 5);
  ASSERT_EQ(periods.size(), 5U);
  EXPECT_DOUBLE_EQ(periods.front(), 0.05);
  EXPECT_NEAR(periods.back(), 4.0, 1e-14);
  EXPECT_NEAR(periods[2], std::sqrt(0.05 * 4.0), 1e-15);
}

}  // namespace
}  // namespace hybridtest::design_motion
