#include "mechanics/laws/takeda.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/config_error.hpp"
#include "core/random.hpp"
#include "mechanics/laws/peak_oriented.hpp"

namespace hybridtest {
namespace {

constexpr double kRounding_n = 1e-8;

/// Cracks at 0.002 m and 16 kN, yields at 0.010 m and 40 kN.
constexpr Takeda::Parameters kColumn{.stiffness_n_per_m = 8.0e6,
                                     .yield_force_n = 4.0e4,
                                     .hardening_ratio = 0.05,
                                     .cracking_force_n = 1.6e4,
                                     .cracked_ratio = 0.375,
                                     .unloading_exponent = 0.4};

double force_after(const Takeda::Parameters& parameters, const std::vector<double>& turns_m) {
  Takeda column{parameters};
  double force_n = 0.0;
  for (const double turn_m : turns_m) {
    force_n = column.trial(turn_m, 0.0);
    column.commit();
  }
  return force_n;
}

TEST(Takeda, FirstLoadingCracksYieldsAndHardens) {
  EXPECT_NEAR(force_after(kColumn, {0.001}), 8.0e3, kRounding_n);
  EXPECT_NEAR(force_after(kColumn, {0.002}), 1.6e4, kRounding_n);
  EXPECT_NEAR(force_after(kColumn, {-0.006}), -2.8e4, kRounding_n);
  EXPECT_NEAR(force_after(kColumn, {0.010}), 4.0e4, kRounding_n);
  EXPECT_NEAR(force_after(kColumn, {0.030}), 4.8e4, kRounding_n);
  EXPECT_NEAR(force_after(kColumn, {0.0015, -0.0015, 0.001}), 8.0e3, kRounding_n);  // elastic until it cracks
}

TEST(Takeda, UnloadsTowardsTheOtherCrackBeforeYielding) {
  // The straight line from (0.006 m, 28 kN) to (-0.002 m, -16 kN), without a corner at zero force.
  EXPECT_NEAR(force_after(kColumn, {0.006, 0.002}), 6.0e3, kRounding_n);
  EXPECT_NEAR(force_after(kColumn, {0.006, -0.001}), -1.05e4, kRounding_n);
  EXPECT_NEAR(force_after(kColumn, {0.006, -0.002}), -1.6e4, kRounding_n);
  EXPECT_NEAR(force_after(kColumn, {0.006, -0.006}), -2.8e4, kRounding_n);
}

TEST(Takeda, UnloadsSofterTheFartherItHasBeen) {
  const double at_yield_n_per_m = (4.0e4 + 1.6e4) / 0.012;
  for (const double top_m : {0.010, 0.020, 0.040, 0.080}) {
    const double expected = at_yield_n_per_m * std::pow(0.010 / top_m, 0.4);
    const double slope = (force_after(kColumn, {top_m}) - force_after(kColumn, {top_m, top_m - 0.001})) / 0.001;
    EXPECT_NEAR(slope, expected, 1e-9 * expected) << top_m;
  }
}

TEST(Takeda, ReloadsTowardsTheLargestDisplacement) {
  const double top_n = force_after(kColumn, {0.030});
  const double low_n = force_after(kColumn, {0.030, -0.020});
  const double unloading = (4.0e4 + 1.6e4) / 0.012 * std::pow(0.010 / 0.020, 0.4);
  const double zero_m = -0.020 - low_n / unloading;
  EXPECT_NEAR(force_after(kColumn, {0.030, -0.020, 0.5 * (zero_m + 0.030)}), 0.5 * top_n, kRounding_n);
}

TEST(Takeda, WithoutCracksAndExponentItIsPeakOriented) {
  Takeda takeda{
      {.stiffness_n_per_m = 4.0e6, .yield_force_n = 4.0e4, .hardening_ratio = 0.05, .unloading_exponent = 0.0}};
  PeakOriented clough{{.stiffness_n_per_m = 4.0e6, .yield_force_n = 4.0e4, .hardening_ratio = 0.05}};
  Random random{4};
  for (int i = 0; i < 200; ++i) {
    const double displacement_m = random.uniform(-0.08, 0.08);
    ASSERT_EQ(takeda.trial(displacement_m, 0.0), clough.trial(displacement_m, 0.0));
    takeda.commit();
    clough.commit();
  }
}

TEST(Takeda, IsNeverStifferThanAtFirst) {
  Random random{22};
  for (int specimen = 0; specimen < 300; ++specimen) {
    auto parameters = kColumn;
    parameters.cracking_force_n = random.uniform(0.0, 3.9e4);
    parameters.cracked_ratio = random.uniform(0.05, 1.0);
    parameters.unloading_exponent = random.uniform();
    Takeda column{parameters};
    double displacement_m = 0.0;
    double force_n = 0.0;
    for (int turn = 0; turn < 40; ++turn) {
      const double step_m = (random.uniform(-0.06, 0.06) - displacement_m) / 50.0;
      for (int i = 0; i < 50; ++i) {
        displacement_m += step_m;
        const double next_n = column.trial(displacement_m, 0.0);
        column.commit();
        ASSERT_LE(std::abs(next_n - force_n), 8.0e6 * std::abs(step_m) * 1.000001) << specimen;
        force_n = next_n;
      }
    }
  }
}

TEST(Takeda, RejectsParametersOutOfRange) {
  auto parameters = kColumn;
  parameters.cracking_force_n = 4.0e4;
  EXPECT_THROW(Takeda{parameters}, ConfigError);
  parameters = kColumn;
  parameters.cracked_ratio = 0.0;
  EXPECT_THROW(Takeda{parameters}, ConfigError);
  parameters = kColumn;
  parameters.unloading_exponent = 1.1;
  EXPECT_THROW(Takeda{parameters}, ConfigError);
}

}  // namespace
}  // namespace hybridtest
