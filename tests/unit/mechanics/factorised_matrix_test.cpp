#include "mechanics/structure/factorised_matrix.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "core/config_error.hpp"
#include "tests/support/malloc_count.hpp"
#include "tests/support/structures.hpp"

namespace hybridtest {
namespace {

using ::testing::HasSubstr;

/// Largest entry of A x - b relative to |A| |x|: a backward error, so a few roundings per row.
double backward_error(const Eigen::MatrixXd& matrix) {
  FactorisedMatrix factorised{matrix.sparseView(), "test"};
  Random random{3};
  Eigen::VectorXd right_hand_side(matrix.rows());
  for (double& entry : right_hand_side) entry = random.uniform(-1.0, 1.0);
  Eigen::VectorXd solution = right_hand_side;
  factorised.solve_in_place(solution);
  const double scale = matrix.cwiseAbs().rowwise().sum().maxCoeff() * solution.cwiseAbs().maxCoeff();
  return (matrix * solution - right_hand_side).cwiseAbs().maxCoeff() / scale;
}

/// Roundings of rows of up to this many entries.
constexpr double rounding(int size) { return 4.0 * size * 2.3e-16; }

Eigen::MatrixXd unsymmetric_matrix(int size) {
  Random random{9};
  Eigen::MatrixXd matrix = test::random_definite_matrix(size, random);
  for (int row = 0; row < size; ++row) matrix(row, (row + 1) % size) += random.uniform(1.0, 2.0);
  return matrix;
}

TEST(FactorisedMatrix, SolvesDiagonalMatrices) {
  const Eigen::MatrixXd diagonal = Eigen::VectorXd::LinSpaced(7, 1.0, 50.0).asDiagonal();
  EXPECT_LE(backward_error(diagonal), rounding(1));
}

TEST(FactorisedMatrix, SolvesSymmetricMatricesSparseAndFull) {
  Random random{2};
  EXPECT_LE(backward_error(test::random_definite_matrix(40, random)), rounding(40));
  const auto building = test::shear_building(200, 1.0e4, 1.0e7);
  const Eigen::MatrixXd effective = building.mass_kg * 1.0e4 + building.initial_stiffness_n_per_m;
  EXPECT_LE(backward_error(effective), rounding(3));
}

TEST(FactorisedMatrix, SolvesReorderedSparseMatrices) {
  // An arrow pointing the wrong way fills in completely unless its rows are reordered.
  Eigen::MatrixXd arrow = 10.0 * Eigen::MatrixXd::Identity(9, 9);
  arrow.row(0).setConstant(1.0);
  arrow.col(0).setConstant(1.0);
  arrow(0, 0) = 20.0;
  EXPECT_LE(backward_error(arrow), rounding(9));
}

TEST(FactorisedMatrix, SolvesUnsymmetricMatrices) {
  EXPECT_LE(backward_error(unsymmetric_matrix(3)), rounding(3));
  EXPECT_LE(backward_error(unsymmetric_matrix(40)), rounding(40));
  Eigen::MatrixXd needs_pivots(3, 3);
  needs_pivots << 0.0, 2.0, 1.0, 1.0, 1.0, 0.0, 4.0, 0.0, 3.0;
  EXPECT_LE(backward_error(needs_pivots), rounding(3));
}

TEST(FactorisedMatrix, RejectsSingularMatrices) {
  const auto complaint = [](const Eigen::MatrixXd& matrix) -> std::string {
    try {
      const FactorisedMatrix factorised{matrix.sparseView(), "effective mass"};
    } catch (const ConfigError& error) {
      return error.what();
    }
    return {};
  };
  Eigen::MatrixXd unsymmetric(2, 2);
  unsymmetric << 1.0, 2.0, 2.0000001, 4.0000002;
  EXPECT_THAT(complaint(Eigen::Vector2d(1.0, 0.0).asDiagonal()), HasSubstr("effective mass matrix is singular"));
  EXPECT_THAT(complaint(Eigen::MatrixXd::Ones(3, 3)), HasSubstr("effective mass matrix is"));
  EXPECT_THAT(complaint(unsymmetric), HasSubstr("effective mass matrix is singular"));
  EXPECT_THAT(complaint(Eigen::Vector2d(1.0, 2.0).asDiagonal()), "");
}

TEST(FactorisedMatrix, DoesNotAllocateWhileSolving) {
  if (!counts_mallocs()) GTEST_SKIP() << "a sanitizer owns the allocator";
  Random random{4};
  const Eigen::MatrixXd symmetric = test::random_definite_matrix(80, random);
  const Eigen::MatrixXd diagonal = symmetric.diagonal().asDiagonal();
  for (const Eigen::MatrixXd& matrix : {symmetric, diagonal, unsymmetric_matrix(80)}) {
    FactorisedMatrix factorised{matrix.sparseView(), "test"};
    Eigen::VectorXd solution = Eigen::VectorXd::Ones(80);
    const std::size_t before = malloc_count();
    factorised.solve_in_place(solution);
    EXPECT_EQ(malloc_count(), before);
  }
}

TEST(FactorisedMatrix, AllocationCountDetectsLibraryAllocations) {
  if (!counts_mallocs()) GTEST_SKIP() << "a sanitizer owns the allocator";
  const Eigen::SparseMatrix<double> matrix = test::shear_building(80, 1.0, 1.0).initial_stiffness_n_per_m;
  const std::size_t before = malloc_count();
  const Eigen::VectorXd product = matrix * Eigen::VectorXd::Ones(80);
  EXPECT_GT(malloc_count(), before);
  EXPECT_DOUBLE_EQ(product.sum(), 1.0);
}

}  // namespace
}  // namespace hybridtest
