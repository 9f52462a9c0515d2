#include "mechanics/laws/self_centring.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

constexpr double kRounding_n = 1e-8;

/// Activates at 0.01 m; the flag is 30 kN high.
constexpr SelfCentring::Parameters kJoint{
    .stiffness_n_per_m = 4.0e6, .activation_force_n = 4.0e4, .hardening_ratio = 0.1, .flag_ratio = 0.75};

double force_after(const std::vector<double>& turns_m) {
  SelfCentring joint{kJoint};
  double force_n = 0.0;
  for (const double turn_m : turns_m) {
    force_n = joint.trial(turn_m, 0.0);
    joint.commit();
  }
  return force_n;
}

TEST(SelfCentring, FollowsTheUpperLineAfterActivation) {
  EXPECT_NEAR(force_after({0.008}), 3.2e4, kRounding_n);
  EXPECT_NEAR(force_after({0.030}), 4.8e4, kRounding_n);
  EXPECT_NEAR(force_after({-0.030}), -4.8e4, kRounding_n);
}

TEST(SelfCentring, UnloadsOverTheFlagAndFollowsItsLowerLine) {
  EXPECT_NEAR(force_after({0.030, 0.026}), 3.2e4, kRounding_n);   // with k
  EXPECT_NEAR(force_after({0.030, 0.0225}), 1.8e4, kRounding_n);  // the corner, 30 kN below the turn
  EXPECT_NEAR(force_after({0.030, 0.0125}), 1.4e4, kRounding_n);  // with b k
  EXPECT_NEAR(force_after({0.030, 0.0025}), 1.0e4, kRounding_n);  // where it meets the first line
  EXPECT_NEAR(force_after({0.030, 0.001}), 4.0e3, kRounding_n);
}

TEST(SelfCentring, NothingRemainsWithoutForce) {
  EXPECT_NEAR(force_after({0.030, 0.0}), 0.0, kRounding_n);
  EXPECT_NEAR(force_after({0.030, -0.008}), -3.2e4, kRounding_n);
  EXPECT_NEAR(force_after({0.030, -0.030, 0.008}), 3.2e4, kRounding_n);
}

TEST(SelfCentring, ReloadsWithinTheFlagElastically) {
  EXPECT_NEAR(force_after({0.030, 0.0125, 0.015}), 2.4e4, kRounding_n);
  EXPECT_NEAR(force_after({0.030, 0.0125, 0.030}), 4.8e4, kRounding_n);
}

/// What a wall that rocks loses of its force goes with the displacement of its weight.
TEST(SelfCentring, NegativeHardeningIsAWallThatRocks) {
  SelfCentring wall{{.stiffness_n_per_m = 4.0e6, .activation_force_n = 4.0e4, .hardening_ratio = -0.05}};
  for (const double displacement_m : {0.005, 0.01, 0.02, 0.06, 0.02, -0.005, -0.06}) {
    const double size_m = std::abs(displacement_m);
    const double expected_n = size_m <= 0.01 ? 4.0e6 * size_m : 4.0e4 - 0.05 * 4.0e6 * (size_m - 0.01);
    EXPECT_NEAR(wall.trial(displacement_m, 0.0), std::copysign(expected_n, displacement_m), kRounding_n);
    wall.commit();
  }
}

TEST(SelfCentring, ACycleDissipatesItsFlag) {
  SelfCentring joint{kJoint};
  constexpr int kSteps = 30000;
  double work_j = 0.0;
  double before_n = 0.0;
  for (int i = 1; i <= 2 * kSteps; ++i) {
    const double displacement_m = 0.030 * (i <= kSteps ? i : 2 * kSteps - i) / kSteps;
    const double force_n = joint.trial(displacement_m, 0.0);
    joint.commit();
    work_j += 0.5 * (before_n + force_n) * (i <= kSteps ? 0.030 : -0.030) / kSteps;
    before_n = force_n;
  }
  // A parallelogram 20 mm long, and 0.9 of 30 kN high between its lines.
  EXPECT_NEAR(work_j, 0.9 * 3.0e4 * 0.020, 1e-3);
}

TEST(SelfCentring, RejectsParametersOutOfRange) {
  auto parameters = kJoint;
  parameters.flag_ratio = 1.1;
  EXPECT_THROW(SelfCentring{parameters}, ConfigError);
  parameters = kJoint;
  parameters.activation_force_n = 0.0;
  EXPECT_THROW(SelfCentring{parameters}, ConfigError);
}

}  // namespace
}  // namespace hybridtest
