#include "coordinator/integrators/initial_ramp.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "coordinator/integrators/central_difference.hpp"
#include "tests/support/malloc_count.hpp"

namespace hybridtest {
namespace {

constexpr double kStep_s = 0.01;

LinearStructure oscillator() {
  LinearStructure structure;
  structure.mass_kg = Eigen::MatrixXd::Constant(1, 1, 2.0).sparseView();
  structure.damping_n_s_per_m = Eigen::MatrixXd::Constant(1, 1, 0.4).sparseView();
  structure.initial_stiffness_n_per_m = Eigen::MatrixXd::Constant(1, 1, 50.0).sparseView();
  structure.influence = Eigen::VectorXd::Ones(1);
  return structure;
}

InitialMotion initial(double displacement_m, double velocity_m_per_s) {
  return {Eigen::VectorXd::Constant(1, displacement_m), Eigen::VectorXd::Constant(1, velocity_m_per_s)};
}

InitialRamp ramp_to(const InitialMotion& motion, const InitialRampSteps& steps) {
  return {std::make_unique<CentralDifference>(oscillator(), kStep_s, motion), motion, kStep_s, steps};
}

const Eigen::VectorXd kNothing = Eigen::VectorXd::Zero(1);

TEST(InitialRamp, BeginsAndEndsSmoothly) {
  constexpr double kDuration_s = 4.0;
  const InitialRampPoint begin = initial_ramp_point(0.0, kDuration_s);
  const InitialRampPoint end = initial_ramp_point(1.0, kDuration_s);
  EXPECT_EQ(begin.displacement, (std::array{0.0, 0.0}));
  EXPECT_EQ(begin.velocity, (std::array{0.0, 0.0}));
  EXPECT_EQ(begin.acceleration, (std::array{0.0, 0.0}));
  EXPECT_EQ(end.displacement, (std::array{1.0, 0.0}));
  EXPECT_EQ(end.velocity, (std::array{0.0, 1.0}));
  EXPECT_EQ(end.acceleration, (std::array{0.0, 0.0}));
}

TEST(InitialRamp, RatesAreThoseOfTheDisplacement) {
  constexpr double kDuration_s = 4.0;
  constexpr double kDifference = 1e-5;
  for (const double x : {0.1, 0.37, 0.5, 0.9}) {
    const InitialRampPoint at = initial_ramp_point(x, kDuration_s);
    const InitialRampPoint before = initial_ramp_point(x - kDifference, kDuration_s);
    const InitialRampPoint after = initial_ramp_point(x + kDifference, kDuration_s);
    for (std::size_t k = 0; k < 2; ++k) {
      const double time_s = 2.0 * kDifference * kDuration_s;
      EXPECT_NEAR(at.velocity[k], (after.displacement[k] - before.displacement[k]) / time_s, 1e-8);
      EXPECT_NEAR(at.acceleration[k], (after.velocity[k] - before.velocity[k]) / time_s, 1e-7);
    }
  }
}

TEST(InitialRamp, ReleasesTheMethodAfterRampAndHold) {
  const InitialMotion motion = initial(0.03, 0.0);
  InitialRamp ramp = ramp_to(motion, {.ramp = 20, .hold = 5});
  double before_m = 0.0;
  for (int step = 0; step < 25; ++step) {
    const double now_m = ramp.current().displacement_m[0];
    EXPECT_GE(now_m, before_m);
    EXPECT_LE(now_m - before_m, 1.9 / 20 * 0.03);
    if (step >= 20) {
      EXPECT_EQ(now_m, 0.03) << "held";
      EXPECT_EQ(ramp.current().velocity_m_per_s[0], 0.0);
    }
    before_m = now_m;
    // A force that is measured on the way has no effect.
    ramp.advance(Eigen::VectorXd::Constant(1, 1e9), kNothing);
    EXPECT_EQ(ramp.completed().displacement_m[0], now_m);
  }
  CentralDifference alone{oscillator(), kStep_s, motion};
  for (int step = 0; step < 50; ++step) {
    ASSERT_EQ(ramp.current().displacement_m, alone.current().displacement_m) << step;
    const Eigen::VectorXd force_n = 50.0 * alone.current().displacement_m;
    ramp.advance(force_n, kNothing);
    alone.advance(force_n, kNothing);
    ASSERT_EQ(ramp.completed().velocity_m_per_s, alone.completed().velocity_m_per_s);
  }
}

TEST(InitialRamp, ReachesTheInitialVelocity) {
  InitialRamp ramp = ramp_to(initial(0.0, 0.2), {.ramp = 100, .hold = 0});
  for (int step = 0; step < 99; ++step) ramp.advance(kNothing, kNothing);
  const double before_m = ramp.current().displacement_m[0];
  ramp.advance(kNothing, kNothing);
  EXPECT_EQ(ramp.current().displacement_m[0], 0.0);
  EXPECT_NEAR((0.0 - before_m) / kStep_s, 0.2, 0.002);
  EXPECT_EQ(ramp.current().velocity_m_per_s[0], 0.2);
}

TEST(InitialRamp, DoesNotAllocate) {
  InitialRamp ramp = ramp_to(initial(0.03, 0.1), {.ramp = 3, .hold = 0});
  const Eigen::VectorXd force_n = Eigen::VectorXd::Ones(1);
  const std::size_t before = malloc_count();
  for (int step = 0; step < 10; ++step) ramp.advance(force_n, force_n);
  EXPECT_EQ(malloc_count(), before);
}

}  // namespace
}  // namespace hybridtest
