#include "mechanics/laws/peak_oriented.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/config_error.hpp"
#include "core/random.hpp"

namespace hybridtest {
namespace {

constexpr double kRounding_n = 1e-8;

/// Yields at 0.01 m.
constexpr PeakOriented::Parameters kClough{.stiffness_n_per_m = 4.0e6, .yield_force_n = 4.0e4, .hardening_ratio = 0.05};

double impose(PeakOriented& spring, double displacement_m) {
  const double force_n = spring.trial(displacement_m, 0.0);
  spring.commit();
  return force_n;
}

/// Force at the end of a path that turns at each of these displacements.
double force_after(const PeakOriented::Parameters& parameters, const std::vector<double>& turns_m) {
  PeakOriented spring{parameters};
  double force_n = 0.0;
  for (const double turn_m : turns_m) force_n = impose(spring, turn_m);
  return force_n;
}

/// Work up to 0.05 m and back to zero force: F dx without what unloading gives back.
constexpr double kTop_n = 4.0e4 + 0.05 * 4.0e6 * 0.04;
constexpr double kExcursion_j = 0.5 * 4.0e4 * 0.01 + 0.5 * (4.0e4 + kTop_n) * 0.04 - 0.5 * kTop_n * kTop_n / 4.0e6;
constexpr double kAfter_m = 0.05 - kTop_n / 4.0e6;

TEST(PeakOriented, FirstLoadingFollowsTheBackbone) {
  auto parameters = kClough;
  parameters.capping_displacement_m = 0.03;
  parameters.post_capping_displacement_m = 0.1;
  parameters.residual_ratio = 0.25;
  PeakOriented spring{parameters};
  EXPECT_NEAR(spring.trial(0.01, 0.0), 4.0e4, kRounding_n);
  EXPECT_NEAR(spring.trial(0.03, 0.0), 4.4e4, kRounding_n);
  EXPECT_NEAR(spring.trial(-0.04, 0.0), -4.6e4, kRounding_n);
  EXPECT_NEAR(spring.trial(0.09, 0.0), 2.3e4, kRounding_n);  // half of the way from the cap to none
  EXPECT_NEAR(spring.trial(0.20, 0.0), 1.0e4, kRounding_n);
}

TEST(PeakOriented, WithoutResidualTheStrengthIsLost) {
  auto parameters = kClough;
  parameters.capping_displacement_m = 0.03;
  parameters.post_capping_displacement_m = 0.1;
  EXPECT_GT(force_after(parameters, {0.139}), 0.0);
  EXPECT_EQ(force_after(parameters, {0.141}), 0.0);
  EXPECT_EQ(force_after(parameters, {0.141, 0.05}), 0.0);
  EXPECT_EQ(force_after(parameters, {0.141, -0.05}), 0.0);
}

TEST(PeakOriented, ReloadsTowardsTheVirginYieldPoint) {
  EXPECT_NEAR(force_after(kClough, {0.05, kAfter_m}), 0.0, kRounding_n);
  const double middle_m = 0.5 * (kAfter_m - 0.01);
  EXPECT_NEAR(force_after(kClough, {0.05, middle_m}), -2.0e4, kRounding_n);
  EXPECT_NEAR(force_after(kClough, {0.05, -0.01}), -4.0e4, kRounding_n);
  EXPECT_NEAR(force_after(kClough, {0.05, -0.03}), -4.4e4, kRounding_n);
}

TEST(PeakOriented, ReloadsTowardsTheLargestDisplacement) {
  // From -0.03 m and -44 kN zero force is at -0.019 m; half of the way from there to 0.05 m.
  EXPECT_NEAR(force_after(kClough, {0.05, -0.03, 0.5 * (0.05 - 0.019)}), 0.5 * kTop_n, kRounding_n);
  EXPECT_NEAR(force_after(kClough, {0.05, -0.03, 0.06}), 4.0e4 + 0.05 * 4.0e6 * 0.05, kRounding_n);
}

TEST(PeakOriented, AimsAtTheLastReversalWhereThatIsStiffer) {
  // Reversal at 0.04 m on the way to the peak; after a small excursion to the other side its line is the stiffer one.
  PeakOriented spring{kClough};
  impose(spring, 0.05);
  impose(spring, -0.03);
  const double turn_n = impose(spring, 0.04);
  const double low_n = impose(spring, 0.025);
  ASSERT_LT(low_n, 0.0);
  const double zero_m = 0.025 - low_n / 4.0e6;
  EXPECT_NEAR(spring.trial(0.5 * (zero_m + 0.04), 0.0), 0.5 * turn_n, kRounding_n);
  EXPECT_NEAR(spring.trial(0.045, 0.0), 0.5 * (turn_n + kTop_n), kRounding_n);
}

TEST(PeakOriented, SmallUnloadingLeavesNoTrace) {
  auto parameters = kClough;
  parameters.strength_capacity_m = 0.5;
  parameters.reloading_capacity_m = 0.5;
  parameters.unloading_capacity_m = 0.5;
  const std::vector<double> ways_m{0.02, -0.03, 0.03};
  std::vector<double> noisy_m;
  for (const double way_m : ways_m) {
    noisy_m.insert(noisy_m.end(), {0.9 * way_m, 0.88 * way_m, 0.95 * way_m, 0.94 * way_m, way_m});
  }
  EXPECT_NEAR(force_after(parameters, noisy_m), force_after(parameters, ways_m), kRounding_n);
  EXPECT_LT(force_after(parameters, ways_m), 0.99 * force_after(kClough, ways_m));  // control: it deteriorates
}

TEST(PeakOriented, LosesStrengthWithTheDissipatedEnergy) {
  auto parameters = kClough;
  parameters.strength_capacity_m = 0.4;
  const double beta = kExcursion_j / (0.4 * 4.0e4 - kExcursion_j);
  ASSERT_GT(beta, 0.1);
  const double yield_n = 4.0e4 * (1.0 - beta);
  const double hardening_n_per_m = 0.05 * 4.0e6 * (1.0 - beta);
  const double expected_n = yield_n + hardening_n_per_m * (0.04 - yield_n / 4.0e6);
  EXPECT_NEAR(force_after(parameters, {0.05, -0.04}), -expected_n, kRounding_n);
  parameters.deterioration_exponent = 2.0;
  EXPECT_LT(force_after(parameters, {0.05, -0.04}), -expected_n);
}

TEST(PeakOriented, LosesStrengthBeyondTheCapWithTheEnergy) {
  auto parameters = kClough;
  parameters.capping_displacement_m = 0.05;
  parameters.post_capping_displacement_m = 0.2;
  parameters.capping_capacity_m = 0.4;
  const double beta = kExcursion_j / (0.4 * 4.0e4 - kExcursion_j);
  const double highest_n = 4.0e4 + 0.05 * 4.0e6 * 0.05;
  const double descent_n_per_m = highest_n / 0.2;
  const double at_zero_n = (highest_n + descent_n_per_m * 0.06) * (1.0 - beta);
  EXPECT_NEAR(force_after(parameters, {0.05, -0.1}), -(at_zero_n - descent_n_per_m * 0.1), kRounding_n);
  // Before the cap nothing has changed.
  EXPECT_NEAR(force_after(parameters, {0.05, -0.02}), -4.2e4, kRounding_n);
}

TEST(PeakOriented, LosesUnloadingStiffnessWithTheEnergy) {
  auto parameters = kClough;
  parameters.unloading_capacity_m = 0.4;
  const double beta = kExcursion_j / (0.4 * 4.0e4 - kExcursion_j);
  EXPECT_NEAR(force_after(parameters, {0.05, 0.045}), kTop_n - 4.0e6 * (1.0 - beta) * 0.005, kRounding_n);
}

TEST(PeakOriented, LosesReloadingStiffnessWithTheEnergy) {
  auto parameters = kClough;
  parameters.reloading_capacity_m = 0.4;
  const double beta = kExcursion_j / (0.4 * 4.0e4 - kExcursion_j);
  const double target_m = 0.01 * (1.0 + beta);
  const double target_n = 4.0e4 + 0.05 * 4.0e6 * (target_m - 0.01);
  EXPECT_NEAR(force_after(parameters, {0.05, 0.0}), -target_n * kAfter_m / (kAfter_m + target_m), kRounding_n);
}

TEST(PeakOriented, IsLostWhereAnExcursionTakesAllThatIsLeft) {
  auto parameters = kClough;
  parameters.strength_capacity_m = 1.9 * kExcursion_j / 4.0e4;
  EXPECT_EQ(force_after(parameters, {0.05, -0.001}), 0.0);
  parameters.strength_capacity_m = 2.1 * kExcursion_j / 4.0e4;
  EXPECT_LT(force_after(parameters, {0.05, -0.001}), 0.0);
}

TEST(PeakOriented, ForceDoesNotDependOnTheStep) {
  auto parameters = kClough;
  parameters.capping_displacement_m = 0.03;
  parameters.post_capping_displacement_m = 0.15;
  parameters.residual_ratio = 0.1;
  parameters.strength_capacity_m = 3.0;
  parameters.capping_capacity_m = 4.0;
  parameters.unloading_capacity_m = 5.0;
  parameters.reloading_capacity_m = 3.0;
  PeakOriented once{parameters};
  PeakOriented finely{parameters};
  Random random{3};
  double from_m = 0.0;
  for (int turn = 0; turn < 30; ++turn) {
    const double to_m = random.uniform(-0.08, 0.08);
    double force_n = 0.0;
    for (int i = 1; i <= 100; ++i) force_n = impose(finely, from_m + (to_m - from_m) * i / 100);
    ASSERT_NEAR(impose(once, to_m), force_n, 1e-6) << "turn " << turn;
    from_m = to_m;
  }
}

TEST(PeakOriented, RejectsParametersOutOfRange) {
  const auto with = [](auto change) {
    auto parameters = kClough;
    change(parameters);
    return PeakOriented{parameters};
  };
  EXPECT_NO_THROW(with([](auto& p) { p.hardening_ratio = 0.0; }));
  EXPECT_THROW(with([](auto& p) { p.stiffness_n_per_m = 0.0; }), ConfigError);
  EXPECT_THROW(with([](auto& p) { p.hardening_ratio = 1.0; }), ConfigError);
  EXPECT_THROW(with([](auto& p) { p.strength_capacity_m = -1.0; }), ConfigError);
  EXPECT_THROW(with([](auto& p) { p.capping_displacement_m = 0.03; }), ConfigError);
}

}  // namespace
}  // namespace hybridtest
