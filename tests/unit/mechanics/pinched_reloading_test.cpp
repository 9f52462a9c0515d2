#include "mechanics/laws/pinched_reloading.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config_error.hpp"
#include "core/random.hpp"
#include "mechanics/laws/peak_oriented.hpp"

namespace hybridtest {
namespace {

constexpr double kRounding_n = 1e-8;

/// Yields at 0.01 m.
PinchedReloading::Parameters pinched(double force_ratio, double displacement_ratio) {
  PinchedReloading::Parameters parameters;
  parameters.stiffness_n_per_m = 4.0e6;
  parameters.yield_force_n = 4.0e4;
  parameters.hardening_ratio = 0.05;
  parameters.pinching_force_ratio = force_ratio;
  parameters.pinching_displacement_ratio = displacement_ratio;
  return parameters;
}

double impose(Law& spring, double displacement_m) {
  const double force_n = spring.trial(displacement_m, 0.0);
  spring.commit();
  return force_n;
}

TEST(PinchedReloading, ReloadsInTwoPartsByTheBreakPoint) {
  PinchedReloading spring{pinched(0.25, 0.4)};
  const double top_n = impose(spring, 0.05);
  ASSERT_NEAR(top_n, 4.8e4, kRounding_n);
  ASSERT_NEAR(impose(spring, -0.03), -4.4e4, kRounding_n);
  const double start_m = -0.03 + 4.4e4 / 4.0e6;
  const double break_m = 0.6 * (0.05 - top_n / 4.0e6);
  const double break_n = 0.25 * top_n * (break_m - start_m) / (0.05 - start_m);
  EXPECT_NEAR(spring.trial(0.5 * (start_m + break_m), 0.0), 0.5 * break_n, kRounding_n);
  EXPECT_NEAR(spring.trial(break_m, 0.0), break_n, kRounding_n);
  EXPECT_NEAR(spring.trial(0.5 * (break_m + 0.05), 0.0), 0.5 * (break_n + top_n), kRounding_n);
  EXPECT_NEAR(spring.trial(0.05, 0.0), top_n, kRounding_n);
  EXPECT_NEAR(spring.trial(0.06, 0.0), 5.0e4, kRounding_n);
}

TEST(PinchedReloading, GoesStraightWhereItStartsBeyondTheBreak) {
  PinchedReloading spring{pinched(0.25, 0.4)};
  const double top_n = impose(spring, 0.05);
  const double low_n = impose(spring, 0.035);
  ASSERT_LT(low_n, 0.0);
  const double start_m = 0.035 - low_n / 4.0e6;
  EXPECT_NEAR(spring.trial(0.5 * (start_m + 0.05), 0.0), 0.5 * top_n, kRounding_n);
}

TEST(PinchedReloading, ForceRatioOfOneIsPeakOriented) {
  PinchedReloading pinching{pinched(1.0, 0.4)};
  PeakOriented straight{pinched(1.0, 0.4)};
  Random random{4};
  for (int i = 0; i < 200; ++i) {
    const double displacement_m = random.uniform(-0.08, 0.08);
    ASSERT_EQ(impose(pinching, displacement_m), impose(straight, displacement_m));
  }
}

/// Up to a hundred yield displacements of path: some specimens lose all strength, others hardly any.
PinchedReloading::Parameters random_specimen(Random& random) {
  auto parameters = pinched(random.uniform(0.05, 1.0), random.uniform(0.0, 1.0));
  const auto capacity_m = [&random] { return random.uniform() < 0.3 ? 0.0 : std::exp(random.uniform(-3.0, 3.0)); };
  parameters.hardening_ratio = random.uniform(0.0, 0.3);
  parameters.capping_displacement_m = random.uniform() < 0.3 ? 0.0 : random.uniform(0.001, 0.1);
  parameters.post_capping_displacement_m = random.uniform(0.05, 0.5);
  parameters.residual_ratio = random.uniform() < 0.3 ? 0.0 : random.uniform(0.0, 0.9);
  parameters.strength_capacity_m = capacity_m();
  parameters.capping_capacity_m = capacity_m();
  parameters.unloading_capacity_m = capacity_m();
  parameters.reloading_capacity_m = capacity_m();
  parameters.deterioration_exponent = random.uniform(0.5, 2.0);
  return parameters;
}

TEST(PinchedReloading, IsNeverStifferThanAtFirst) {
  Random random{21};
  int lost = 0;
  for (int specimen = 0; specimen < 500; ++specimen) {
    PinchedReloading spring{random_specimen(random)};
    double displacement_m = 0.0;
    double force_n = 0.0;
    for (int turn = 0; turn < 40; ++turn) {
      const double to_m = random.uniform(-0.06, 0.06);
      const double step_m = (to_m - displacement_m) / 50.0;
      for (int i = 0; i < 50; ++i) {
        displacement_m += step_m;
        const double next_n = impose(spring, displacement_m);
        // Where the strength is lost, it is lost at once.
        if (next_n != 0.0) {
          ASSERT_LE(std::abs(next_n - force_n), 4.0e6 * std::abs(step_m) * 1.000001)
              << specimen << " at " << displacement_m;
        }
        force_n = next_n;
      }
    }
    lost += force_n == 0.0 ? 1 : 0;
  }
  EXPECT_GT(lost, 50);  // control: both kinds were drawn
  EXPECT_LT(lost, 450);
}

TEST(PinchedReloading, RejectsParametersOutOfRange) {
  EXPECT_NO_THROW(PinchedReloading{pinched(1.0, 1.0)});
  EXPECT_THROW(PinchedReloading{pinched(0.0, 0.5)}, ConfigError);
  EXPECT_THROW(PinchedReloading{pinched(1.1, 0.5)}, ConfigError);
  EXPECT_THROW(PinchedReloading{pinched(0.5, 1.1)}, ConfigError);
}

}  // namespace
}  // namespace hybridtest
