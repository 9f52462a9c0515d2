#include "coordinator/preflight/site_coupling.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config_error.hpp"
#include "tests/support/structures.hpp"

namespace hybridtest {
namespace {

CoupledSite spring(const InterfaceMap& interface, double stiffness_n_per_m) {
  CoupledSite site;
  site.id = "storey";
  site.interface = interface;
  site.stiffness_n_per_m = Eigen::MatrixXd::Constant(1, 1, stiffness_n_per_m);
  return site;
}

TEST(SiteCoupling, StoreySharesAddUpToOneInEachMode) {
  const LinearStructure structure = test::two_storeys();
  const VibrationModes modes = vibration_modes(structure);
  const auto lower = stiffness_share_by_mode(structure, modes, spring(InterfaceMap{2, {{0}}}, 4.0e6));
  const auto upper = stiffness_share_by_mode(structure, modes, spring(InterfaceMap{2, {{1, 0}}}, 3.0e6));
  EXPECT_NEAR(lower[0] + upper[0], 1.0, 1e-14);
  EXPECT_NEAR(lower[1] + upper[1], 1.0, 1e-14);
  // Shape (1, x) with x = 3/(3 - 0.02 omega^2): strain energies 4 and 3 (x - 1)^2.
  const double x = 3.0 / (3.0 - 0.02 * modes.frequency_rad_per_s[0] * modes.frequency_rad_per_s[0]);
  EXPECT_NEAR(lower[0], 4.0 / (4.0 + 3.0 * (x - 1.0) * (x - 1.0)), 1e-12);
}

TEST(SiteCoupling, MotionWithoutStiffnessHasNoShare) {
  const LinearStructure structure = test::oscillator(2.0, 0.0, 0.0);
  const VibrationModes modes = vibration_modes(structure);
  EXPECT_TRUE(std::isnan(stiffness_share_by_mode(structure, modes, spring(InterfaceMap{1, {{0}}}, 0.0))[0]));
}

TEST(SiteCoupling, RejectsMatricesOfOtherSize) {
  const LinearStructure structure = test::two_storeys();
  CoupledSite site = spring(InterfaceMap{2, {{0}}}, 1.0);
  EXPECT_NO_THROW(require_consistent(structure, site));
  site.damping_n_s_per_m = Eigen::MatrixXd::Zero(2, 2);
  EXPECT_THROW(require_consistent(structure, site), ConfigError);
  site = spring(InterfaceMap{3, {{0}}}, 1.0);
  EXPECT_THROW(require_consistent(structure, site), ConfigError);
  site = spring(InterfaceMap{2, {{0}}}, std::nan(""));
  EXPECT_THROW(require_consistent(structure, site), ConfigError);
}

}  // namespace
}  // namespace hybridtest
