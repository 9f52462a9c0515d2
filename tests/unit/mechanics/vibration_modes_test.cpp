#include "mechanics/structure/vibration_modes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/config_error.hpp"
#include "tests/support/structures.hpp"

namespace hybridtest {
namespace {

TEST(VibrationModes, EqualStoreyBuildingMatchesClosedForm) {
  // omega_j = 2 sqrt(k/m) sin((2j - 1) pi / (4n + 2)), phi_j(i) ~ sin(i (2j - 1) pi / (2n + 1)).
  constexpr int kStoreys = 40;
  const VibrationModes modes = vibration_modes(test::shear_building(kStoreys, 2.0e4, 5.0e6));
  for (int mode = 0; mode < kStoreys; ++mode) {
    const double angle = (2 * mode + 1) * std::numbers::pi / (2 * kStoreys + 1);
    const double expected = 2.0 * std::sqrt(5.0e6 / 2.0e4) * std::sin(angle / 2.0);
    EXPECT_NEAR(modes.frequency_rad_per_s[mode], expected, 1e-10 * expected);
    Eigen::VectorXd shape(kStoreys);
    for (int floor = 0; floor < kStoreys; ++floor) shape[floor] = std::sin((floor + 1) * angle);
    EXPECT_NEAR(std::abs(shape.normalized().dot(modes.shapes.col(mode).normalized())), 1.0, 1e-12);
  }
}

TEST(VibrationModes, MatchReferenceBuilding) {
  // 8.35 and 20.74 rad/s; the closed form of a two-storey building to the last digits.
  const VibrationModes modes = vibration_modes(test::two_storeys());
  const double mean = (7.0e6 + 3.0e6) / 2.0;
  const double spread = std::sqrt(2.0e6 * 2.0e6 + 3.0e6 * 3.0e6);
  EXPECT_NEAR(modes.frequency_rad_per_s[0], std::sqrt((mean - spread) / 20.0e3), 1e-12);
  EXPECT_NEAR(modes.frequency_rad_per_s[1], std::sqrt((mean + spread) / 20.0e3), 1e-12);
  EXPECT_NEAR(modes.frequency_rad_per_s[0], 8.35, 0.005);
  EXPECT_NEAR(modes.frequency_rad_per_s[1], 20.74, 0.005);
  EXPECT_NEAR(modes.period_s(0), 2.0 * std::numbers::pi / modes.frequency_rad_per_s[0], 1e-15);
}

TEST(VibrationModes, AreMassNormalisedAndOrthogonalWithFullMatrices) {
  Random random{5};
  const Eigen::MatrixXd mass = test::random_definite_matrix(12, random);
  const Eigen::MatrixXd stiffness = 1e4 * test::random_definite_matrix(12, random);
  const VibrationModes modes = vibration_modes(test::structure_of(mass, mass, stiffness));
  const Eigen::MatrixXd identity = modes.shapes.transpose() * mass * modes.shapes;
  EXPECT_LT((identity - Eigen::MatrixXd::Identity(12, 12)).cwiseAbs().maxCoeff(), 1e-13);
  const Eigen::MatrixXd squares = modes.shapes.transpose() * stiffness * modes.shapes;
  const Eigen::MatrixXd expected = modes.frequency_rad_per_s.cwiseAbs2().asDiagonal();
  EXPECT_LT((squares - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.maxCoeff());
}

TEST(VibrationModes, EffectiveMassesSumToTotalMass) {
  LinearStructure structure = test::shear_building(7, 3.0e3, 1.0e6);
  EXPECT_NEAR(vibration_modes(structure).effective_mass_kg.sum(), 7 * 3.0e3, 1e-8);
  structure.influence[6] = 0.0;
  EXPECT_NEAR(vibration_modes(structure).effective_mass_kg.sum(), 6 * 3.0e3, 1e-8);
}

TEST(VibrationModes, LargestEntryOfEachShapeIsPositive) {
  const VibrationModes modes = vibration_modes(test::shear_building(9, 1.0, 1.0));
  for (Eigen::Index mode = 0; mode < modes.count(); ++mode) {
    EXPECT_GT(modes.shapes.col(mode).maxCoeff(), -modes.shapes.col(mode).minCoeff());
  }
}

TEST(VibrationModes, MotionWithoutStiffnessHasZeroFrequency) {
  Eigen::MatrixXd free(2, 2);
  free << 5.0, -5.0, -5.0, 5.0;
  const VibrationModes modes =
      vibration_modes(test::structure_of(Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd::Zero(2, 2), free));
  EXPECT_EQ(modes.frequency_rad_per_s[0], 0.0);
  EXPECT_TRUE(std::isinf(modes.period_s(0)));
  EXPECT_NEAR(modes.highest_frequency_rad_per_s(), std::sqrt(10.0), 1e-14);
}

TEST(VibrationModes, RejectsNegativeStiffness) {
  EXPECT_THROW(static_cast<void>(vibration_modes(test::oscillator(1.0, 0.0, -1.0))), ConfigError);
}

}  // namespace
}  // namespace hybridtest
