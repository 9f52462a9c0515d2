#include "mechanics/laws/bilinear.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config_error.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/unit/mechanics/reference_history.hpp"

namespace hybridtest {
namespace {

constexpr Bilinear::Parameters kColumn{.stiffness_n_per_m = 4.0e6, .yield_force_n = 4.0e4, .hardening_ratio = 0.05};
constexpr double kYield_m = 0.01;

double impose(Bilinear& spring, double displacement_m) {
  const double force_n = spring.trial(displacement_m, 0.0);
  spring.commit();
  return force_n;
}

TEST(Bilinear, FollowsItsBackboneAndUnloadsElastically) {
  Bilinear spring{kColumn};
  EXPECT_DOUBLE_EQ(impose(spring, 0.005), 2.0e4);
  EXPECT_DOUBLE_EQ(impose(spring, 0.03), 4.0e4 + 0.05 * 4.0e6 * 0.02);
  EXPECT_NEAR(impose(spring, 0.02), 4.4e4 - 4.0e4, 1e-9);  // a difference of large forces, rounded
  // Kinematic hardening: the elastic range stays 2 Fy wide, so yielding back begins at 0.01 m.
  EXPECT_DOUBLE_EQ(impose(spring, 0.01), 4.4e4 - 8.0e4);
  EXPECT_DOUBLE_EQ(impose(spring, -0.01), -3.6e4 - 0.05 * 4.0e6 * 0.02);
  EXPECT_EQ(spring.initial_stiffness_n_per_m(), 4.0e6);
}

/// An elastic, perfectly plastic column of height h under an axial load P that it is not modelled with:
/// F = G(x) - P / h x is bilinear with k - P / h before and -P / h after yielding.
TEST(Bilinear, NegativeHardeningIsAnAxialLoad) {
  constexpr double kLoadOverHeight_n_per_m = 0.2e6;
  Bilinear column{{.stiffness_n_per_m = 4.0e6, .yield_force_n = 4.0e4, .hardening_ratio = 0.0}};
  constexpr double kUnderLoad_n_per_m = 4.0e6 - kLoadOverHeight_n_per_m;
  Bilinear softening{{.stiffness_n_per_m = kUnderLoad_n_per_m,
                      .yield_force_n = kUnderLoad_n_per_m * kYield_m,
                      .hardening_ratio = -kLoadOverHeight_n_per_m / kUnderLoad_n_per_m}};
  for (int i = 0; i < 2000; ++i) {
    const double displacement_m = 5e-5 * i * std::sin(0.05 * i);
    const double expected_n = impose(column, displacement_m) - kLoadOverHeight_n_per_m * displacement_m;
    ASSERT_NEAR(impose(softening, displacement_m), expected_n, 1e-10 * 4.0e4);  // rounding only
  }
}

TEST(Bilinear, MonotonicMotionIsIndependentOfStepCount) {
  Bilinear in_one{kColumn};
  Bilinear in_many{kColumn};
  for (const double target_m : {0.03, -0.05, 0.04}) {
    const double begin_m = target_m > 0.0 ? -0.05 : 0.03;
    const double once_n = impose(in_one, target_m);
    double many_n = 0.0;
    for (int i = 1; i <= 1000; ++i) many_n = impose(in_many, begin_m + (target_m - begin_m) * i / 1000.0);
    EXPECT_NEAR(many_n, once_n, 1e-9 * 4.0e4);  // rounding only
  }
}

TEST(Bilinear, ElasticMotionLeavesNoResidual) {
  Bilinear shaken{kColumn};
  Bilinear still{kColumn};
  impose(shaken, 0.010013);  // plastic by 13 micrometres,
  impose(still, 0.010013);
  // which differences with much larger displacements round.
  for (int i = 0; i < 1000; ++i) impose(shaken, 0.0099 * std::sin(0.1 * i * i));
  for (const double displacement_m : {0.0, 1e-5, 0.005, 0.05})
    EXPECT_EQ(shaken.trial(displacement_m, 0.0), still.trial(displacement_m, 0.0));
}

TEST(Bilinear, DissipatedEnergyEqualsLoopArea) {
  Bilinear spring{kColumn};
  constexpr double kAmplitude_m = 0.03;
  constexpr int kQuarter = 300;  // corners of the loop fall on samples, so the trapezoids are exact
  double energy_j = 0.0;
  double previous_m = 0.0;
  double previous_n = 0.0;
  const auto move_to = [&](double displacement_m) {
    const double force_n = impose(spring, displacement_m);
    energy_j += 0.5 * (force_n + previous_n) * (displacement_m - previous_m);
    previous_m = displacement_m;
    previous_n = force_n;
  };
  for (int i = 1; i <= kQuarter; ++i) move_to(kAmplitude_m * i / kQuarter);
  energy_j = 0.0;
  for (int i = 1; i <= 2 * kQuarter; ++i) move_to(kAmplitude_m * (kQuarter - i) / kQuarter);
  for (int i = 1; i <= 2 * kQuarter; ++i) move_to(kAmplitude_m * (i - kQuarter) / kQuarter);
  const double expected_j = 4.0 * (1.0 - 0.05) * 4.0e4 * (kAmplitude_m - kYield_m);
  EXPECT_NEAR(energy_j, expected_j, 1e-10 * expected_j);
}

TEST(Bilinear, AgreesWithOpenSees) {
  const auto file = shared_data("reference/two_storey_bilinear.csv");
  HYBRIDTEST_NEEDS_DATA(file);
  const ReferenceHistory reference = read_reference(file);
  Bilinear spring{kColumn};
  // The recorded run had 20 steps per sample; what remains is the interpolation of its
  // displacement, some 1e-7 m where the recorded acceleration has a corner.
  constexpr int kStepsPerSample = 20;
  for (std::size_t i = 1; i < reference.force_n.size(); ++i) {
    for (int step = 1; step < kStepsPerSample; ++step)
      impose(spring, reference.displacement_between(i - 1, static_cast<double>(step) / kStepsPerSample));
    ASSERT_NEAR(impose(spring, reference.displacement_m[i]), reference.force_n[i], 2e-5 * reference.largest_force_n());
  }
}

TEST(Bilinear, RejectsParametersOutOfRange) {
  const auto with = [](auto change) {
    Bilinear::Parameters parameters = kColumn;
    change(parameters);
    return Bilinear{parameters};
  };
  EXPECT_NO_THROW(with([](auto& p) { p.hardening_ratio = 0.0; }));
  EXPECT_THROW(with([](auto& p) { p.stiffness_n_per_m = 0.0; }), ConfigError);
  EXPECT_THROW(with([](auto& p) { p.yield_force_n = -1.0; }), ConfigError);
  EXPECT_THROW(with([](auto& p) { p.hardening_ratio = 1.0; }), ConfigError);
  EXPECT_NO_THROW(with([](auto& p) { p.hardening_ratio = -0.99; }));
  EXPECT_THROW(with([](auto& p) { p.hardening_ratio = -1.0; }), ConfigError);
  EXPECT_THROW(with([](auto& p) { p.yield_force_n = std::nan(""); }), ConfigError);
}

}  // namespace
}  // namespace hybridtest
