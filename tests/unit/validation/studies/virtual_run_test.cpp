#include "validation/studies/rths_benchmark/virtual_run.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "compensation/no_compensation.hpp"
#include "compensation/no_force_compensation.hpp"
#include "validation/studies/rths_benchmark/candidates.hpp"

namespace hybridtest::rths {
namespace {

/// Two seconds of a gentle sine.
GroundMotion short_motion(double amplitude_m_per_s2) {
  GroundMotion motion{.dt_s = 0.01, .start_s = 0.0, .acceleration_m_per_s2 = {}};
  for (int i = 0; i <= 200; ++i) {
    motion.acceleration_m_per_s2.push_back(amplitude_m_per_s2 * std::sin(2.0 * std::numbers::pi * 2.0 * 0.01 * i));
  }
  return motion;
}

TestResult run_ours(const GroundMotion& motion, bool has_noise, std::uint64_t stream, TestHistory* history = nullptr) {
  const Candidate ours = chosen_candidates({std::string{kOurs}}).front();
  const Reference reference = make_reference(1, motion);
  return run_virtual_test({.case_number = 1,
                           .motion = motion,
                           .reference = reference,
                           .plant = {},
                           .has_sensor_noise = has_noise,
                           .noise_seed = 3,
                           .noise_stream = stream},
                          *ours.make_path(), *ours.make_force_compensator(), history);
}

TEST(VirtualTest, SameSeedGivesSameBytesOtherStreamDiffers) {
  const GroundMotion motion = short_motion(0.5);
  const TestResult first = run_ours(motion, true, 5);
  const TestResult again = run_ours(motion, true, 5);
  const TestResult other = run_ours(motion, true, 6);
  ASSERT_TRUE(first.is_complete);
  EXPECT_EQ(first.criteria.values, again.criteria.values);
  EXPECT_NE(first.criteria.j(2), other.criteria.j(2));
}

TEST(VirtualTest, PerfectTrackingLeavesSensorNoiseInJ2) {
  const TestResult result = run_ours(short_motion(0.5), true, 1);
  // Independent sums of squares: noise and what tracking leaves. A standard deviation of 8000 samples scatters by 0.8
  // %.
  EXPECT_NEAR(result.criteria.j(2), std::hypot(result.noise_floor_percent, result.true_tracking_percent),
              0.03 * result.criteria.j(2));
}

TEST(VirtualTest, WithoutNoiseMeasuredEqualsTrue) {
  const TestResult result = run_ours(short_motion(0.5), false, 1);
  EXPECT_EQ(result.criteria.j(2), result.true_tracking_percent);
}

TEST(VirtualTest, ZeroGroundMotionGivesZeroResponse) {
  TestHistory history;
  const GroundMotion motion = short_motion(0.0);
  static_cast<void>(run_ours(motion, false, 1, &history));
  for (const double value : history.true_m) ASSERT_EQ(value, 0.0);
  for (const double value : history.floor_3_m) ASSERT_EQ(value, 0.0);
}

TEST(VirtualTest, EndsBeyondForceLimitAndReportsIt) {
  const GroundMotion motion = short_motion(4.0);
  const Reference reference = make_reference(1, motion);
  CompensatedPath path{std::make_unique<NoCompensation>(), Arrangement::straight};
  NoForceCompensation forces;
  TestHistory history;
  const TestResult result = run_virtual_test({.case_number = 1, .motion = motion, .reference = reference, .plant = {}},
                                             path, forces, &history);
  EXPECT_FALSE(result.is_complete);
  EXPECT_TRUE(result.reaches_force_limit());
  EXPECT_LT(history.true_m.size(), reference.samples());
  EXPECT_TRUE(std::isnan(result.criteria.j(6)));
}

}  // namespace
}  // namespace hybridtest::rths
