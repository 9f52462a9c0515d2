#include "mechanics/structure/reduction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "core/config_error.hpp"
#include "mechanics/structure/vibration_modes.hpp"
#include "tests/support/structures.hpp"

namespace hybridtest {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// With its stiffness in the elastic part.
LinearStructure elastic(const Eigen::MatrixXd& mass_kg, const Eigen::MatrixXd& stiffness_n_per_m) {
  LinearStructure structure =
      test::structure_of(mass_kg, Eigen::MatrixXd::Zero(mass_kg.rows(), mass_kg.rows()), stiffness_n_per_m);
  structure.stiffness_n_per_m = structure.initial_stiffness_n_per_m;
  structure.damping_n_s_per_m.resize(0, 0);
  return structure;
}

/// Springs in series: two masses with massless points between them and the ground.
LinearStructure springs_in_series() {
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(4, 4);
  const Eigen::Vector4d spring(2.0e6, 3.0e6, 4.0e6, 5.0e6);  // ground, 0, 1, 2, 3
  for (int i = 0; i < 4; ++i) {
    stiffness(i, i) += spring[i];
    if (i == 0) continue;
    stiffness(i - 1, i - 1) += spring[i];
    stiffness(i, i - 1) -= spring[i];
    stiffness(i - 1, i) -= spring[i];
  }
  LinearStructure structure = elastic(Eigen::Vector4d(0.0, 10.0, 0.0, 20.0).asDiagonal(), stiffness);
  structure.degrees_of_freedom = {"a", "b", "c", "d"};
  return structure;
}

TEST(WithoutMassless, SpringsInSeriesAddTheirFlexibilities) {
  const ReducedStructure reduced = without_massless(springs_in_series());
  EXPECT_THAT(reduced.kept, ElementsAre(1, 3));
  EXPECT_THAT(reduced.structure.degrees_of_freedom, ElementsAre("b", "d"));
  const double lower = 1.0 / (1.0 / 2.0e6 + 1.0 / 3.0e6);
  const double upper = 1.0 / (1.0 / 4.0e6 + 1.0 / 5.0e6);
  const Eigen::MatrixXd expected{{lower + upper, -upper}, {-upper, upper}};
  EXPECT_LT((Eigen::MatrixXd{reduced.structure.stiffness_n_per_m} - expected).cwiseAbs().maxCoeff(), 1e-9 * upper);
  EXPECT_EQ(Eigen::MatrixXd{reduced.structure.mass_kg}, Eigen::MatrixXd{Eigen::Vector2d(10.0, 20.0).asDiagonal()});
  EXPECT_EQ(reduced.structure.influence, Eigen::Vector2d::Ones());
}

TEST(WithoutMassless, KeepsTheFrequenciesOfFullMatrices) {
  // With hardly any mass instead of none, the whole problem has the same lowest frequencies.
  constexpr int kSize = 90;
  constexpr int kMassless = 70;
  Random random{3};
  Eigen::VectorXd mass = Eigen::VectorXd::Constant(kSize, 5.0);
  mass.head(kMassless).setZero();
  const Eigen::MatrixXd stiffness = 1e5 * test::random_definite_matrix(kSize, random);
  const ReducedStructure reduced = without_massless(elastic(mass.asDiagonal(), stiffness));
  ASSERT_EQ(reduced.structure.size(), kSize - kMassless);
  mass.head(kMassless).setConstant(1e-9);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> whole{stiffness, Eigen::MatrixXd{mass.asDiagonal()}};
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> less{
      Eigen::MatrixXd{reduced.structure.stiffness_n_per_m}, Eigen::MatrixXd{reduced.structure.mass_kg}};
  for (int mode = 0; mode < kSize - kMassless; ++mode) {
    EXPECT_NEAR(less.eigenvalues()[mode], whole.eigenvalues()[mode], 1e-6 * whole.eigenvalues()[mode]) << mode;
  }
}

TEST(WithoutMassless, StructureWithMassEverywhereStays) {
  const LinearStructure given =
      elastic(Eigen::Vector2d(1.0, 2.0).asDiagonal(), Eigen::Matrix2d{{3.0, -1.0}, {-1.0, 1.0}});
  const ReducedStructure reduced = without_massless(given);
  EXPECT_THAT(reduced.kept, ElementsAre(0, 1));
  EXPECT_EQ(Eigen::MatrixXd{reduced.structure.stiffness_n_per_m}, Eigen::MatrixXd{given.stiffness_n_per_m});
}

TEST(WithoutMassless, RefusesWhatCannotBeCondensedByName) {
  LinearStructure loose = springs_in_series();
  loose.stiffness_n_per_m.coeffRef(2, 2) = 0.0;
  loose.stiffness_n_per_m.coeffRef(2, 1) = loose.stiffness_n_per_m.coeffRef(1, 2) = 0.0;
  loose.stiffness_n_per_m.coeffRef(2, 3) = loose.stiffness_n_per_m.coeffRef(3, 2) = 0.0;
  EXPECT_THAT([&] { static_cast<void>(without_massless(loose)); },
              ThrowsMessage<ConfigError>(HasSubstr("'c' has no mass, and nothing holds it")));
  LinearStructure coupled = springs_in_series();
  coupled.mass_kg.coeffRef(0, 1) = coupled.mass_kg.coeffRef(1, 0) = 1.0;
  EXPECT_THAT([&] { static_cast<void>(without_massless(coupled)); },
              ThrowsMessage<ConfigError>(HasSubstr("'a' has no mass, but its row of the mass matrix is not zero")));
  LinearStructure damped = springs_in_series();
  damped.damping_n_s_per_m.resize(4, 4);
  damped.damping_n_s_per_m.coeffRef(2, 2) = 1.0;
  EXPECT_THAT([&] { static_cast<void>(without_massless(damped)); },
              ThrowsMessage<ConfigError>(HasSubstr("'c' has no mass, but damping of its own")));
  LinearStructure skew = springs_in_series();
  skew.stiffness_n_per_m.coeffRef(0, 1) = 0.0;
  EXPECT_THAT([&] { static_cast<void>(without_massless(skew)); },
              ThrowsMessage<ConfigError>(HasSubstr("stiffness matrix is not symmetric")));
}

TEST(WithConstraints, RigidFloorMovesAsOneBody) {
  // Two columns at -3 m and 5 m of a floor that moves along x (0) and turns (1); the tops of the columns follow.
  const double left = 2.0e6;
  const double right = 1.0e6;
  LinearStructure given = elastic(Eigen::Vector4d(8.0e3, 6.0e4, 500.0, 500.0).asDiagonal(),
                                  Eigen::Vector4d(0.0, 0.0, left, right).asDiagonal());
  given.influence = Eigen::Vector4d(1.0, 0.0, 1.0, 1.0);
  const ReducedStructure reduced = with_constraints(
      given, {{.dof = 2, .follows = {{0, 1.0}, {1, -3.0}}}, {.dof = 3, .follows = {{0, 1.0}, {1, 5.0}}}});
  EXPECT_THAT(reduced.kept, ElementsAre(0, 1));
  const Eigen::MatrixXd stiffness{{left + right, -3.0 * left + 5.0 * right},
                                  {-3.0 * left + 5.0 * right, 9.0 * left + 25.0 * right}};
  const Eigen::MatrixXd mass{{9.0e3, 1.0e3}, {1.0e3, 6.0e4 + 9.0 * 500.0 + 25.0 * 500.0}};
  EXPECT_EQ(Eigen::MatrixXd{reduced.structure.stiffness_n_per_m}, stiffness);
  EXPECT_EQ(Eigen::MatrixXd{reduced.structure.mass_kg}, mass);
  EXPECT_EQ(reduced.structure.influence, Eigen::Vector2d(1.0, 0.0));
}

TEST(WithConstraints, RefusesChainsAndSecondConstraints) {
  const LinearStructure given = springs_in_series();
  EXPECT_THAT(
      [&] {
        static_cast<void>(
            with_constraints(given, {{.dof = 0, .follows = {{1, 1.0}}}, {.dof = 1, .follows = {{2, 1.0}}}}));
      },
      ThrowsMessage<ConfigError>(HasSubstr("'a' follows 'b', which has a constraint itself")));
  EXPECT_THAT(
      [&] {
        static_cast<void>(
            with_constraints(given, {{.dof = 0, .follows = {{1, 1.0}}}, {.dof = 0, .follows = {{2, 1.0}}}}));
      },
      ThrowsMessage<ConfigError>(HasSubstr("'a' has two constraints")));
  EXPECT_THAT(
      [&] {
        static_cast<void>(with_constraints(given, {{.dof = 0, .follows = {{0, 1.0}}}}));
      },
      ThrowsMessage<ConfigError>(HasSubstr("'a' follows 'a'")));
}

}  // namespace
}  // namespace hybridtest
