#include "experimental_site/trajectory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/random.hpp"

namespace hybridtest {
namespace {

constexpr double kStep = 0.01;
constexpr double kAmplitude = 0.05;
constexpr double kOmega = 2.0 * std::numbers::pi;

CommandPoint sine_target(Step step) {
  const double time = static_cast<double>(step) * kStep;
  CommandPoint point;
  point.step = step;
  point.model_time_s = time;
  point.displacement_m = InterfaceVector::Constant(1, kAmplitude * std::sin(kOmega * time));
  point.velocity_m_per_s = InterfaceVector::Constant(1, kAmplitude * kOmega * std::cos(kOmega * time));
  point.acceleration_m_per_s2 = InterfaceVector::Constant(1, -kAmplitude * kOmega * kOmega * std::sin(kOmega * time));
  return point;
}

TEST(TrajectoryTest, ReachesEachTargetExactlyAtItsTime) {
  Trajectory trajectory{1, kStep, 1.0};
  trajectory.reset(InterfaceVector::Zero(1));
  ReachedTarget reached;
  trajectory.set_target(sine_target(0));
  ASSERT_TRUE(trajectory.advance(kStep / 4, reached));
  EXPECT_EQ(trajectory.point().path_time_s, 0.0);
  for (Step step = 1; step <= 200; ++step) {
    trajectory.set_target(sine_target(step));
    for (int period = 0; period < 3; ++period) ASSERT_FALSE(trajectory.advance(kStep / 4, reached));
    ASSERT_TRUE(trajectory.advance(kStep / 4, reached));
    EXPECT_EQ(reached.target.step, step);
    EXPECT_EQ(reached.fraction, 1.0);
    EXPECT_FALSE(any(reached.flags));
    EXPECT_EQ(trajectory.point().displacement_m[0], sine_target(step).displacement_m[0]) << "to the last bit";
  }
}

TEST(TrajectoryTest, IsACubicBetweenTargetsThatAreKnown) {
  // The error of cubic Hermite interpolation is at most h^4/384 max|x''''|.
  Trajectory trajectory{1, kStep, 1.0};
  ReachedTarget reached;
  trajectory.set_target(sine_target(0));
  static_cast<void>(trajectory.advance(kStep / 8, reached));
  const double bound = std::pow(kStep, 4) / 384.0 * kAmplitude * std::pow(kOmega, 4);
  double worst = 0.0;
  for (Step step = 1; step <= 100; ++step) {
    trajectory.set_target(sine_target(step));
    for (int period = 0; period < 8; ++period) {
      static_cast<void>(trajectory.advance(kStep / 8, reached));
      const double exact = kAmplitude * std::sin(kOmega * trajectory.point().path_time_s);
      // The first piece starts at rest where the sine moves: it is the soft start, not the cubic.
      if (step > 1) worst = std::max(worst, std::abs(trajectory.point().displacement_m[0] - exact));
    }
  }
  EXPECT_LE(worst, bound * (1.0 + 1e-6));
  EXPECT_GE(worst, 0.5 * bound) << "the bound is sharp; a smaller error means that nothing was measured";
}

TEST(TrajectoryTest, SlowsDownAndWaitsShortOfTheStepsEndWhenTheTargetIsLate) {
  Trajectory trajectory{1, kStep, 1.0};
  ReachedTarget reached;
  trajectory.set_target(sine_target(0));
  static_cast<void>(trajectory.advance(kStep / 10, reached));
  for (int period = 0; period < 1000; ++period) ASSERT_FALSE(trajectory.advance(kStep / 10, reached));
  EXPECT_LT(trajectory.point().path_time_s, kStep);
  EXPECT_GT(trajectory.point().path_time_s, 0.99 * kStep);
  EXPECT_TRUE(trajectory.point().is_held);
  EXPECT_NEAR(trajectory.point().velocity_m_per_s[0], 0.0, 1e-9);

  trajectory.set_target(sine_target(1));
  bool is_reached = false;
  for (int period = 0; period < 20 && !is_reached; ++period) is_reached = trajectory.advance(kStep / 10, reached);
  ASSERT_TRUE(is_reached);
  EXPECT_TRUE(any(reached.flags & MeasurementFlags::held));
  EXPECT_TRUE(any(reached.flags & MeasurementFlags::late));
}

/// Largest second difference of the position over a run with random arrival times, over the
/// period squared: an acceleration. A jump of the velocity by dv shows as dv / period.
double largest_acceleration(std::uint64_t seed, double period_s) {
  Random random{seed};
  Trajectory trajectory{1, kStep, 1.0};
  ReachedTarget reached;
  trajectory.set_target(sine_target(0));
  static_cast<void>(trajectory.advance(period_s, reached));
  Step next = 1;
  double wait_s = 0.0;
  double before = 0.0;
  double here = 0.0;
  double worst = 0.0;
  for (int period = 0; period < 4000; ++period) {
    wait_s -= period_s;
    if (!trajectory.has_target() && wait_s <= 0.0) {
      trajectory.set_target(sine_target(next++));
      wait_s = random.uniform(0.2, 2.5) * kStep;  // from comfortably early to more than a step late
    }
    static_cast<void>(trajectory.advance(period_s, reached));
    const double there = trajectory.point().displacement_m[0];
    if (period > 1) worst = std::max(worst, std::abs(there - 2.0 * here + before) / (period_s * period_s));
    before = here;
    here = there;
  }
  return worst;
}

TEST(TrajectoryTest, VelocityIsContinuousWheneverTargetsArrive) {
  // Continuous velocity means an acceleration that stays bounded as the sampling gets finer; a
  // jump would double it with each halving of the period.
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const double coarse = largest_acceleration(seed, kStep / 50);
    const double fine = largest_acceleration(seed, kStep / 400);
    EXPECT_LT(fine, 2.0 * coarse) << "seed " << seed;
  }
}

}  // namespace
}  // namespace hybridtest
