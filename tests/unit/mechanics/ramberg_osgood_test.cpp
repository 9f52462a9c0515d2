#include "mechanics/laws/ramberg_osgood.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/config_error.hpp"
#include "core/random.hpp"

namespace hybridtest {
namespace {

constexpr double kYield_m = 0.01;
constexpr RambergOsgood::Parameters kSteel{
    .stiffness_n_per_m = 4.0e6, .yield_force_n = 4.0e4, .offset_ratio = 0.5, .exponent = 6.0};

/// The inverse of the law, which is explicit.
double first_loading_m(double force_n) {
  const double force = force_n / kSteel.yield_force_n;
  return kYield_m * force * (1.0 + kSteel.offset_ratio * std::pow(std::abs(force), kSteel.exponent - 1.0));
}

double impose(RambergOsgood& steel, double displacement_m) {
  const double force_n = steel.trial(displacement_m, 0.0);
  steel.commit();
  return force_n;
}

double force_after(const std::vector<double>& turns_m) {
  RambergOsgood steel{kSteel};
  double force_n = 0.0;
  for (const double turn_m : turns_m) force_n = impose(steel, turn_m);
  return force_n;
}

TEST(RambergOsgood, FirstLoadingFollowsItsEquation) {
  for (const double force_n : {1.0e-3, 1.0e3, 2.0e4, 4.0e4, -6.0e4, 1.0e6})
    EXPECT_NEAR(force_after({first_loading_m(force_n)}), force_n, 1e-12 * std::abs(force_n));
}

TEST(RambergOsgood, ABranchIsFirstLoadingTwiceAsLarge) {
  const double top_m = first_loading_m(6.0e4);
  for (const double drop_n : {1.0e3, 4.0e4, 1.0e5})
    EXPECT_NEAR(force_after({top_m, top_m - 2.0 * first_loading_m(0.5 * drop_n)}), 6.0e4 - drop_n, 1e-7);
}

TEST(RambergOsgood, GoesOnWithFirstLoadingBeyondTheMirrorImage) {
  const double top_m = first_loading_m(5.0e4);
  EXPECT_NEAR(force_after({top_m, -top_m}), -5.0e4, 1e-7);
  EXPECT_NEAR(force_after({top_m, first_loading_m(-6.0e4)}), -6.0e4, 1e-7);
}

TEST(RambergOsgood, ClosedLoopsLeaveNoTrace) {
  const double plain_n = force_after({0.03, -0.02, 0.025});
  EXPECT_NEAR(force_after({0.03, -0.02, 0.01, -0.005, 0.005, -0.005, 0.025}), plain_n, 1e-7);
  EXPECT_NEAR(force_after({0.03, -0.02, 0.01, -0.02, 0.025}), plain_n, 1e-7);
  EXPECT_NEAR(force_after({0.03, -0.02, 0.035}), force_after({0.035}), 1e-7);
}

TEST(RambergOsgood, ForceDoesNotDependOnTheStep) {
  RambergOsgood once{kSteel};
  RambergOsgood finely{kSteel};
  Random random{3};
  double from_m = 0.0;
  for (int turn = 0; turn < 100; ++turn) {
    const double to_m = random.uniform(-0.05, 0.05);
    double force_n = 0.0;
    for (int i = 1; i <= 50; ++i) force_n = impose(finely, from_m + (to_m - from_m) * i / 50);
    ASSERT_NEAR(impose(once, to_m), force_n, 1e-6) << "turn " << turn;
    from_m = to_m;
  }
}

TEST(RambergOsgood, MoreNestedLoopsThanItRemembersStaySmooth) {
  RambergOsgood steel{kSteel};
  double before_n = 0.0;
  double before_m = 0.0;
  for (int i = 0; i < 400; ++i) {
    const double displacement_m = (i % 2 == 0 ? 0.05 : -0.05) * (1.0 - i / 400.0);
    const double force_n = impose(steel, displacement_m);
    ASSERT_LE(std::abs(force_n - before_n), 4.0e6 * std::abs(displacement_m - before_m) * (1.0 + 1e-12));
    before_n = force_n;
    before_m = displacement_m;
  }
  EXPECT_NEAR(impose(steel, 0.06), force_after({0.06}), 1e-7);
}

TEST(RambergOsgood, ACycleDissipatesTheAreaOfItsLoop) {
  RambergOsgood steel{kSteel};
  const double top_m = first_loading_m(6.0e4);
  constexpr int kSteps = 20000;
  impose(steel, top_m);
  double work_j = 0.0;
  double before_n = 6.0e4;
  for (int i = 1; i <= 2 * kSteps; ++i) {
    const double displacement_m = top_m * (i <= kSteps ? 1.0 - 2.0 * i / kSteps : 2.0 * i / kSteps - 3.0);
    const double force_n = impose(steel, displacement_m);
    work_j += 0.5 * (before_n + force_n) * (i <= kSteps ? -2.0 : 2.0) * top_m / kSteps;
    before_n = force_n;
  }
  // 4 Fa xp (n - 1) / (n + 1), with the plastic displacement xp of the turn (Jennings, 1964).
  const double plastic_m = top_m - 6.0e4 / 4.0e6;
  const double expected_j = 4.0 * 6.0e4 * plastic_m * 5.0 / 7.0;
  EXPECT_NEAR(work_j, expected_j, 1e-7 * expected_j);
}

TEST(RambergOsgood, RejectsParametersOutOfRange) {
  auto parameters = kSteel;
  parameters.exponent = 0.9;
  EXPECT_THROW(RambergOsgood{parameters}, ConfigError);
  parameters = kSteel;
  parameters.offset_ratio = -0.1;
  EXPECT_THROW(RambergOsgood{parameters}, ConfigError);
}

}  // namespace
}  // namespace hybridtest
