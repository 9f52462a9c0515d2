#include "coordinator/preflight/free_vibration.hpp"

#include <gtest/gtest.h>

#include "tests/support/integration_methods.hpp"
#include "tests/support/structures.hpp"

namespace hybridtest {
namespace {

Eigen::SparseMatrix<double> spring(double stiffness_n_per_m) {
  return test::oscillator(1.0, 0.0, stiffness_n_per_m).initial_stiffness_n_per_m;
}

TEST(FreeVibration, GrowsBeyondTheExcessThatCrAllows) {
  // omega dt of the excess is 2 where it is 4 N/m.
  const auto grows = [](double excess) {
    return free_vibration_grows(*test::cr().make(test::oscillator(1.0, 0.0, 1.0), 1.0, {}), spring(1.0 + excess));
  };
  EXPECT_FALSE(grows(0.0));
  EXPECT_FALSE(grows(3.99));
  EXPECT_TRUE(grows(4.01));
}

TEST(FreeVibration, BeatsOfUndampedModesAreNotGrowth) {
  const LinearStructure building = test::shear_building(6, 1.0, 1.0);
  for (const test::IntegrationMethod& method : test::all_methods()) {
    EXPECT_FALSE(free_vibration_grows(*method.make(building, 0.5, {}), building.initial_stiffness_n_per_m))
        << method.name;
  }
}

TEST(FreeVibration, GrowsAboveTheCriticalDelay) {
  // All stiffness is late by tau: nearly as if the damping were c - k tau.
  constexpr double kStep_s = 0.01;
  const LinearStructure structure = test::oscillator(1.0, 0.04, 1.0);
  const auto grows = [&](double delay_s) {
    return free_vibration_grows(*test::explicit_methods()[0].make(structure, kStep_s, {}), spring(0.0),
                                {{spring(1.0), delay_s / kStep_s}});
  };
  EXPECT_FALSE(grows(-0.02));
  EXPECT_FALSE(grows(0.0));
  EXPECT_FALSE(grows(0.035));
  EXPECT_TRUE(grows(0.095));
}

}  // namespace
}  // namespace hybridtest
