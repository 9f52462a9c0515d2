#include "coordinator/excitation/ground_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hybridtest {
namespace {

const GroundMotion kRamp{.dt_s = 0.5, .start_s = 0.0, .acceleration_m_per_s2 = {1.0, 3.0, -1.0}};

TEST(GroundMotion, InterpolatesLinearly) {
  EXPECT_EQ(kRamp.at(0.0), 1.0);
  EXPECT_EQ(kRamp.at(0.125), 1.5);
  EXPECT_EQ(kRamp.at(0.5), 3.0);
  EXPECT_EQ(kRamp.at(0.75), 1.0);
  EXPECT_EQ(kRamp.at(1.0), -1.0);
}

TEST(GroundMotion, IsZeroOutsideItsDuration) {
  EXPECT_EQ(kRamp.at(1.001), 0.0);
  EXPECT_EQ(kRamp.at(1e300), 0.0);
  EXPECT_EQ(kRamp.at(-0.001), 0.0);
  EXPECT_EQ(kRamp.at(std::numeric_limits<double>::quiet_NaN()), 0.0);
  EXPECT_EQ(GroundMotion{}.at(0.0), 0.0);
}

TEST(GroundMotion, ReachesLastValueDespiteRounding) {
  GroundMotion motion{.dt_s = 0.02, .start_s = 0.0, .acceleration_m_per_s2 = std::vector<double>(1559, 2.0)};
  for (int step = 0; step <= 31160; ++step) ASSERT_NEAR(motion.at(step * 0.001), 2.0, 1e-15) << step;
  EXPECT_EQ(motion.at(31.161), 0.0);
}

TEST(GroundMotion, MayStartLate) {
  GroundMotion motion = kRamp;
  motion.start_s = 2.0;
  EXPECT_EQ(motion.at(1.9), 0.0);
  EXPECT_EQ(motion.at(2.125), 1.5);
  EXPECT_EQ(motion.end_s(), 3.0);
}

TEST(GroundMotion, IsSampledAtEachStep) {
  EXPECT_EQ(kRamp.sampled(0.25, 6), (std::vector<double>{1.0, 2.0, 3.0, 1.0, -1.0, 0.0, 0.0}));
}

TEST(GroundMotion, PeakIsTheLargestMagnitude) {
  EXPECT_EQ(kRamp.peak_m_per_s2(), 3.0);
  EXPECT_EQ((GroundMotion{.dt_s = 1.0, .start_s = 0.0, .acceleration_m_per_s2 = {1.0, -4.0}}).peak_m_per_s2(), 4.0);
}

}  // namespace
}  // namespace hybridtest
