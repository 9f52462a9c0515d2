#include "mechanics/structure/linear_structure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/config_error.hpp"
#include "tests/support/structures.hpp"

namespace hybridtest {
namespace {

using ::testing::HasSubstr;

std::string complaint(const LinearStructure& structure) {
  try {
    require_consistent(structure);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

TEST(LinearStructure, AcceptsAFullMassMatrix) {
  Random random{1};
  const auto matrix = test::random_definite_matrix(5, random);
  EXPECT_EQ(complaint(test::structure_of(matrix, matrix, matrix)), "");
}

TEST(LinearStructure, LoadIsMinusMassTimesInfluence) {
  LinearStructure structure = test::two_storeys();
  EXPECT_EQ(structure.load_per_ground_acceleration_kg(), Eigen::Vector2d(-20.0e3, -20.0e3));
  structure.influence << 1.0, 0.0;  // the second degree of freedom stands across the motion
  EXPECT_EQ(structure.load_per_ground_acceleration_kg(), Eigen::Vector2d(-20.0e3, 0.0));
}

TEST(LinearStructure, NamesDegreeOfFreedomWithoutMass) {
  LinearStructure structure = test::two_storeys();
  structure.mass_kg.coeffRef(1, 1) = 0.0;
  EXPECT_THAT(complaint(structure), HasSubstr("'floor_2' has no mass"));
  structure.degrees_of_freedom.clear();
  EXPECT_THAT(complaint(structure), HasSubstr("number 2 has no mass"));
}

TEST(LinearStructure, RejectsSingularMassMatrix) {
  const Eigen::MatrixXd singular = Eigen::MatrixXd::Ones(2, 2);
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(2, 2);
  EXPECT_THAT(complaint(test::structure_of(singular, identity, identity)), HasSubstr("not positive definite"));
}

TEST(LinearStructure, RejectsUnsymmetricStiffness) {
  LinearStructure structure = test::two_storeys();
  structure.initial_stiffness_n_per_m.coeffRef(0, 1) = -2.9e6;
  EXPECT_THAT(complaint(structure), HasSubstr("initial stiffness matrix is not symmetric"));
}

TEST(LinearStructure, RejectsNonFiniteNumbers) {
  LinearStructure structure = test::two_storeys();
  structure.initial_stiffness_n_per_m.coeffRef(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(complaint(structure), HasSubstr("not finite"));
}

TEST(LinearStructure, ListsAllInconsistentSizes) {
  LinearStructure structure = test::two_storeys();
  structure.degrees_of_freedom = {"roof"};
  structure.influence = Eigen::VectorXd::Ones(3);
  structure.damping_n_s_per_m.resize(3, 3);
  EXPECT_THAT(complaint(structure), HasSubstr("1 names"));
  EXPECT_THAT(complaint(structure), HasSubstr("influence vector has 3"));
  EXPECT_THAT(complaint(structure), HasSubstr("damping matrix is 3 by 3, expected 2 by 2"));
}

TEST(LinearStructure, RejectsEmptyStructure) {
  EXPECT_THAT(complaint(LinearStructure{}), HasSubstr("no degree of freedom"));
}

}  // namespace
}  // namespace hybridtest
