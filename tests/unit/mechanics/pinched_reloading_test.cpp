#include "mechanics/laws/pinched_reloading.hpp"

#include <gtest/gtest.h>

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

TEST(PinchedReloading, RejectsParametersOutOfRange) {
  EXPECT_NO_THROW(PinchedReloading{pinched(1.0, 1.0)});
  EXPECT_THROW(PinchedReloading{pinched(0.0, 0.5)}, ConfigError);
  EXPECT_THROW(PinchedReloading{pinched(1.1, 0.5)}, ConfigError);
  EXPECT_THROW(PinchedReloading{pinched(0.5, 1.1)}, ConfigError);
}

}  // namespace
}  // namespace hybridtest
