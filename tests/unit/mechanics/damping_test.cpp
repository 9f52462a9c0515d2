#include "mechanics/structure/damping.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "core/config_error.hpp"
#include "tests/support/structures.hpp"

namespace hybridtest {
namespace {

using ::testing::HasSubstr;

template <typename Action>
std::string complaint(const Action& action) {
  try {
    static_cast<void>(action());
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

TEST(RayleighDamping, MatchesReferenceCoefficients) {
  const RayleighCoefficients coefficients = rayleigh_coefficients(0.02, 1, 2, vibration_modes(test::two_storeys()));
  EXPECT_NEAR(coefficients.mass_per_s, 0.23813881290184155, 1e-14);
  EXPECT_NEAR(coefficients.stiffness_s, 0.0013748950773337615, 1e-16);
}

TEST(RayleighDamping, GivesRatioAtBothModesAndLessBetween) {
  LinearStructure structure = test::shear_building(6, 2.0e4, 8.0e6);
  const VibrationModes modes = vibration_modes(structure);
  structure.damping_n_s_per_m = rayleigh_damping(structure, rayleigh_coefficients(0.05, 1, 4, modes));
  const Eigen::VectorXd ratios = damping_ratios(structure, modes);
  EXPECT_NEAR(ratios[0], 0.05, 1e-14);
  EXPECT_NEAR(ratios[3], 0.05, 1e-14);
  EXPECT_LT(ratios[1], 0.05);
  EXPECT_GT(ratios[5], 0.05);
  const auto swapped = rayleigh_coefficients(0.05, 4, 1, modes);
  EXPECT_EQ(swapped.mass_per_s, rayleigh_coefficients(0.05, 1, 4, modes).mass_per_s);
}

TEST(RayleighDamping, RejectsInvalidModesAndRatios) {
  const LinearStructure structure = test::two_storeys();
  const VibrationModes modes = vibration_modes(structure);
  EXPECT_THAT(complaint([&] { return rayleigh_coefficients(0.02, 1, 1, modes); }), HasSubstr("different frequency"));
  EXPECT_THAT(complaint([&] { return rayleigh_coefficients(0.02, 1, 3, modes); }),
              HasSubstr("mode 3, expected a mode from 1 to 2"));
  EXPECT_THAT(complaint([&] { return rayleigh_coefficients(0.02, 0, 1, modes); }), HasSubstr("mode 0"));
  EXPECT_THAT(complaint([&] { return rayleigh_coefficients(2.0, 1, 2, modes); }), HasSubstr("damping ratio is 2"));
  EXPECT_THAT(complaint([&] { return rayleigh_damping(structure, {-0.1, 0.0}); }), HasSubstr("-0.1"));
  Eigen::MatrixXd free(2, 2);
  free << 5.0, -5.0, -5.0, 5.0;
  const auto floating =
      vibration_modes(test::structure_of(Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd::Zero(2, 2), free));
  EXPECT_THAT(complaint([&] { return rayleigh_coefficients(0.02, 1, 2, floating); }), HasSubstr("no stiffness"));
}

TEST(ModalDamping, GivesEachModeItsRatioAndCouplesNone) {
  Random random{6};
  const Eigen::MatrixXd mass = test::random_definite_matrix(5, random);
  LinearStructure structure =
      test::structure_of(mass, Eigen::MatrixXd::Zero(5, 5), 1e4 * test::random_definite_matrix(5, random));
  const VibrationModes modes = vibration_modes(structure);
  const Eigen::Vector3d ratios(0.02, 0.0, 0.07);
  structure.damping_n_s_per_m = modal_damping(structure, modes, ratios);
  const Eigen::MatrixXd modal = modes.shapes.transpose() * Eigen::MatrixXd{structure.damping_n_s_per_m} * modes.shapes;
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(5);
  expected.head(3) = 2.0 * ratios.cwiseProduct(modes.frequency_rad_per_s.head(3));
  const Eigen::MatrixXd expected_modal = expected.asDiagonal();
  EXPECT_LT((modal - expected_modal).cwiseAbs().maxCoeff(), 1e-12 * expected.maxCoeff());
}

TEST(ModalDamping, ReproducesPublishedBenchmarkMatrix) {
  // Virtual RTHS benchmark (Silva et al., 2020), case 1: 1000 kg per floor, 5 % in all modes.
  Eigen::MatrixXd stiffness(3, 3);
  stiffness << 26054883.879603837, -23133938.877108198, 5937035.463339146, -23133938.877108198, 32560774.186380334,
      -14419970.777236985, 5937035.463339146, -14419970.777236985, 9267275.506224312;
  Eigen::MatrixXd published(3, 3);
  published << 14084.275745299876, -7873.031460913151, 440.45149884262497, -7873.031460913151, 14943.622937895665,
      -6348.672096305332, 440.45149884262497, -6348.672096305332, 7223.101316804461;
  const LinearStructure structure =
      test::structure_of(1000.0 * Eigen::MatrixXd::Identity(3, 3), Eigen::MatrixXd::Zero(3, 3), stiffness);
  const Eigen::MatrixXd damping{modal_damping(structure, vibration_modes(structure), Eigen::Vector3d::Constant(0.05))};
  // The published matrix stands 1.2e-5 off the one that follows from its own K, M and ratios.
  EXPECT_LT((damping - published).cwiseAbs().maxCoeff(), 2e-5 * published.maxCoeff());
}

TEST(ModalDamping, RejectsWrongNumberOfRatios) {
  const LinearStructure structure = test::two_storeys();
  const VibrationModes modes = vibration_modes(structure);
  EXPECT_THAT(complaint([&] { return modal_damping(structure, modes, Eigen::Vector3d::Constant(0.02)); }),
              HasSubstr("3 ratios, expected from 1 to 2"));
  EXPECT_THAT(complaint([&] { return modal_damping(structure, modes, Eigen::Vector2d(0.02, -0.1)); }),
              HasSubstr("-0.1"));
}

}  // namespace
}  // namespace hybridtest
