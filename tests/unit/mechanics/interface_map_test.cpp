#include "mechanics/structure/interface_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "core/config_error.hpp"
#include "core/random.hpp"
#include "tests/support/malloc_count.hpp"

namespace hybridtest {
namespace {

constexpr int kStructureSize = 7;

/// Absolute degrees of freedom, drifts in both directions, a shared base, one listed twice.
InterfaceMap interface() { return {kStructureSize, {{0}, {2, 1}, {1, 2}, {6, 2}, {0}}}; }

/// Written down by hand, row by row.
Eigen::MatrixXd interface_matrix() {
  Eigen::MatrixXd matrix(5, kStructureSize);
  matrix << 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,  //
      0.0, -1.0, 1.0, 0.0, 0.0, 0.0, 0.0,       //
      0.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0,       //
      0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0,       //
      1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0;
  return matrix;
}

Eigen::VectorXd random_vector(Eigen::Index size, Random& random) {
  Eigen::VectorXd values{size};
  for (double& value : values) value = random.uniform(-1.0, 1.0);
  return values;
}

/// Largest difference between both products of `map` and those of the dense matrix `b`.
double distance(const InterfaceMap& map, const Eigen::MatrixXd& b) {
  Random random{5};
  double largest = 0.0;
  for (int i = 0; i < 20; ++i) {
    const Eigen::VectorXd displacement_m = random_vector(map.structure_size(), random);
    const Eigen::VectorXd force_n = random_vector(map.size(), random);
    const Eigen::VectorXd before_n = random_vector(map.structure_size(), random);
    InterfaceVector at_interface_m;
    map.to_interface(displacement_m, at_interface_m);
    Eigen::VectorXd structure_n = before_n;
    map.add_to_structure(force_n, structure_n);
    largest = std::max(largest, (at_interface_m - b * displacement_m).cwiseAbs().maxCoeff());
    largest = std::max(largest, (structure_n - before_n - b.transpose() * force_n).cwiseAbs().maxCoeff());
  }
  return largest;
}

TEST(InterfaceMap, MatrixHoldsOneAndMinusOne) { EXPECT_EQ(interface().matrix(), interface_matrix()); }

TEST(InterfaceMap, ProductsEqualThoseOfTheDenseMatrix) { EXPECT_LT(distance(interface(), interface_matrix()), 1e-15); }

TEST(InterfaceMap, ComparisonSeesOneWrongSign) {  // control of the test before
  Eigen::MatrixXd wrong = interface_matrix();
  wrong(3, 2) = 1.0;
  EXPECT_GT(distance(interface(), wrong), 0.1);
}

TEST(InterfaceMap, ConservesWork) {
  const InterfaceMap map = interface();
  Random random{6};
  for (int i = 0; i < 100; ++i) {
    const Eigen::VectorXd displacement_m = random_vector(map.structure_size(), random);
    const Eigen::VectorXd force_n = random_vector(map.size(), random);
    InterfaceVector at_interface_m;
    map.to_interface(displacement_m, at_interface_m);
    Eigen::VectorXd structure_n = Eigen::VectorXd::Zero(map.structure_size());
    map.add_to_structure(force_n, structure_n);
    EXPECT_NEAR(force_n.dot(at_interface_m), structure_n.dot(displacement_m), 1e-14);
  }
}

TEST(InterfaceMap, AddsInTheOrderOfTheInterface) {
  // 1e16 + 1 is 1e16 in double precision: another order of the sum gives another result.
  const InterfaceMap map{1, {{0}, {0}, {0}}};
  Eigen::VectorXd structure_n = Eigen::VectorXd::Zero(1);
  map.add_to_structure(Eigen::Vector3d{1e16, 1.0, -1e16}, structure_n);
  EXPECT_EQ(structure_n[0], 0.0);
  structure_n.setZero();
  map.add_to_structure(Eigen::Vector3d{1e16, -1e16, 1.0}, structure_n);
  EXPECT_EQ(structure_n[0], 1.0);
}

TEST(InterfaceMap, KnowsWhichStructureDofsItUses) {
  const std::array<bool, kStructureSize> expected{true, true, true, false, false, false, true};
  for (int dof = 0; dof < kStructureSize; ++dof) {
    EXPECT_EQ(interface().uses(dof), expected[static_cast<std::size_t>(dof)]) << dof;
  }
}

TEST(InterfaceMap, ProductsDoNotAllocate) {
  if (!counts_mallocs()) GTEST_SKIP() << "a sanitizer has the allocator for itself";
  const InterfaceMap map = interface();
  const Eigen::MatrixXd displacement_m = Eigen::MatrixXd::Ones(kStructureSize, 3);
  Eigen::MatrixXd structure_n = Eigen::MatrixXd::Zero(kStructureSize, 3);
  InterfaceVector values = InterfaceVector::Ones(map.size());
  const std::size_t before = malloc_count();
  for (Eigen::Index column = 0; column < 3; ++column) {
    map.to_interface(displacement_m.col(column), values);
    map.add_to_structure(values, structure_n.col(column));
  }
  EXPECT_EQ(malloc_count(), before);
  const Eigen::MatrixXd dense = map.matrix();
  EXPECT_GT(malloc_count(), before) << "the count must see an allocation of Eigen, control";
}

TEST(InterfaceMap, OnStructureIsTheTripleProduct) {
  const Eigen::MatrixXd b = interface_matrix();
  Eigen::MatrixXd stiffness(b.rows(), b.rows());
  for (Eigen::Index i = 0; i < stiffness.size(); ++i) stiffness.reshaped()[i] = static_cast<double>(i * i % 17);
  EXPECT_EQ(Eigen::MatrixXd{interface().on_structure(stiffness)}, b.transpose() * stiffness * b);
}

TEST(InterfaceMap, RejectsDofsThatTheStructureDoesNotHave) {
  EXPECT_THROW((InterfaceMap{3, {{3}}}), ConfigError);
  EXPECT_THROW((InterfaceMap{3, {{-1}}}), ConfigError);
  EXPECT_THROW((InterfaceMap{3, {{0, 3}}}), ConfigError);
  EXPECT_THROW((InterfaceMap{3, {{0, -2}}}), ConfigError);
  EXPECT_THROW((InterfaceMap{3, {{1, 1}}}), ConfigError);
  EXPECT_NO_THROW((InterfaceMap{3, {{2, 0}}}));
}

TEST(InterfaceMap, RejectsMoreDofsThanAMessageHolds) {
  EXPECT_NO_THROW((InterfaceMap{1, std::vector<InterfaceDof>(kMaxInterfaceDofs)}));
  EXPECT_THROW((InterfaceMap{1, std::vector<InterfaceDof>(kMaxInterfaceDofs + 1)}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
