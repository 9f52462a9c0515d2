#include "validation/design_motion/baseline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/random.hpp"

namespace hybridtest::design_motion {
namespace {

TEST(Baseline, IntegratesStraightAccelerationsExactly) {
  constexpr double kStep_s = 0.1;
  std::vector<double> ramp;
  for (int i = 0; i <= 50; ++i) ramp.push_back(1.0 - 0.6 * i * kStep_s);
  const auto velocity = velocity_m_per_s(ramp, kStep_s);
  const auto displacement = displacement_m(ramp, kStep_s);
  for (std::size_t i = 0; i < ramp.size(); ++i) {
    const double time_s = static_cast<double>(i) * kStep_s;
    EXPECT_NEAR(velocity[i], time_s - 0.3 * time_s * time_s, 1e-13);
    EXPECT_NEAR(displacement[i], 0.5 * time_s * time_s - 0.1 * time_s * time_s * time_s, 1e-13);
  }
}

TEST(Baseline, DriftIsRemovedBySmallCorrection) {
  Random random{8};
  std::vector<double> motion;
  for (int i = 0; i < 3000; ++i) motion.push_back(random.normal() + 0.05);
  const auto original = motion;
  remove_drift(motion, 0.01);
  EXPECT_NEAR(velocity_m_per_s(motion, 0.01).back(), 0.0, 1e-12);
  EXPECT_NEAR(displacement_m(motion, 0.01).back(), 0.0, 1e-11);
  EXPECT_EQ(motion.front(), original.front());
  double change = 0.0;
  for (std::size_t i = 0; i < motion.size(); ++i) change = std::max(change, std::abs(motion[i] - original[i]));
  EXPECT_GT(std::abs(velocity_m_per_s(original, 0.01).back()), 0.5);  // there was something to remove
  EXPECT_LT(change, 0.3);
}

}  // namespace
}  // namespace hybridtest::design_motion
