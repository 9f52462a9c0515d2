#include "mechanics/structure/factorised_matrix.hpp"

#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <limits>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// Pivots below this share of the largest are rounding of zero.
constexpr double kPivotTolerance = 64.0 * std::numeric_limits<double>::epsilon();

bool is_diagonal(const SparseMatrix& matrix) {
  for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry{matrix, column}; entry; ++entry) {
      if (entry.row() != entry.col() && entry.value() != 0.0) return false;
    }
  }
  return true;
}

/// The factorisation reads one triangle, so rounding differences between both are harmless.
bool is_symmetric(const SparseMatrix& matrix) {
  const SparseMatrix transposed = matrix.transpose();  // compressed, which the matrix itself need not be
  const SparseMatrix difference = matrix - transposed;
  if (difference.nonZeros() == 0) return true;
  return difference.coeffs().abs().maxCoeff() <= 1e-12 * transposed.coeffs().abs().maxCoeff();
}

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw ConfigError{"the " + name + " matrix is " + what};
}

}  // namespace

FactorisedMatrix::FactorisedMatrix(const SparseMatrix& matrix, const std::string& name) {
  if (is_diagonal(matrix)) {
    diagonal_ = matrix.diagonal();
    if (!diagonal_.allFinite()) refuse(name, "not finite");
    if (diagonal_.cwiseAbs().minCoeff() <= 0.0) refuse(name, "singular: it has a zero on its diagonal");
  } else if (is_symmetric(matrix)) {
    kind_ = Kind::symmetric;
    factorise_symmetric(matrix, name);
  } else {
    kind_ = Kind::unsymmetric;
    factorise_unsymmetric(matrix, name);
  }
  ordered_ = Eigen::VectorXd::Zero(matrix.rows());
}

void FactorisedMatrix::factorise_symmetric(const SparseMatrix& matrix, const std::string& name) {
  const Eigen::SimplicialLDLT<SparseMatrix> factor{matrix};
  if (factor.info() != Eigen::Success) refuse(name, "singular");
  diagonal_ = factor.vectorD();
  if (!diagonal_.allFinite()) refuse(name, "not finite");
  if (diagonal_.minCoeff() <= kPivotTolerance * diagonal_.maxCoeff()) refuse(name, "not positive definite");
  lower_ = SparseMatrix{factor.matrixL()}.triangularView<Eigen::StrictlyLower>();
  lower_.makeCompressed();
  // The factors are of P A P^T, P taking row indices()[i] of the result from row i of A.
  order_.resize(matrix.rows());
  for (int row = 0; row < matrix.rows(); ++row) {
    const bool is_ordered = factor.permutationP().size() > 0;
    order_[is_ordered ? factor.permutationP().indices()[row] : row] = row;
  }
}

void FactorisedMatrix::factorise_unsymmetric(const SparseMatrix& matrix, const std::string& name) {
  if (matrix.rows() > kMaxUnsymmetricSize) {
    refuse(name, "unsymmetric with " + std::to_string(matrix.rows()) + " rows, expected at most " +
                     std::to_string(kMaxUnsymmetricSize) + " unless it is symmetric");
  }
  const Eigen::PartialPivLU<Eigen::MatrixXd> factor{Eigen::MatrixXd{matrix}};
  lower_upper_ = factor.matrixLU();
  if (!lower_upper_.allFinite()) refuse(name, "singular");
  const Eigen::VectorXd pivots = lower_upper_.diagonal().cwiseAbs();
  if (pivots.minCoeff() <= kPivotTolerance * pivots.maxCoeff()) refuse(name, "singular");
  order_.resize(matrix.rows());
  for (int row = 0; row < matrix.rows(); ++row) order_[factor.permutationP().indices()[row]] = row;
}

void FactorisedMatrix::solve_in_place(Eigen::VectorXd& right_hand_side) noexcept {
  switch (kind_) {
    case Kind::diagonal: right_hand_side.array() /= diagonal_.array(); break;
    case Kind::symmetric: solve_symmetric(right_hand_side); break;
    case Kind::unsymmetric: solve_unsymmetric(right_hand_side); break;
  }
}

void FactorisedMatrix::solve_symmetric(Eigen::VectorXd& x) noexcept {
  const Eigen::Index size = diagonal_.size();
  for (Eigen::Index row = 0; row < size; ++row) ordered_[row] = x[order_[row]];
  for (Eigen::Index column = 0; column < size; ++column) {
    const double known = ordered_[column];
    for (SparseMatrix::InnerIterator entry{lower_, column}; entry; ++entry) {
      ordered_[entry.row()] -= entry.value() * known;
    }
  }
  ordered_.array() /= diagonal_.array();
  for (Eigen::Index column = size - 1; column >= 0; --column) {
    double sum = ordered_[column];
    for (SparseMatrix::InnerIterator entry{lower_, column}; entry; ++entry) {
      sum -= entry.value() * ordered_[entry.row()];
    }
    ordered_[column] = sum;
  }
  for (Eigen::Index row = 0; row < size; ++row) x[order_[row]] = ordered_[row];
}

void FactorisedMatrix::solve_unsymmetric(Eigen::VectorXd& x) noexcept {
  const Eigen::Index size = lower_upper_.rows();
  for (Eigen::Index row = 0; row < size; ++row) ordered_[row] = x[order_[row]];
  for (Eigen::Index column = 0; column < size; ++column) {
    const double known = ordered_[column];
    for (Eigen::Index row = column + 1; row < size; ++row) ordered_[row] -= lower_upper_(row, column) * known;
  }
  for (Eigen::Index column = size - 1; column >= 0; --column) {
    const double known = ordered_[column] / lower_upper_(column, column);
    ordered_[column] = known;
    for (Eigen::Index row = 0; row < column; ++row) ordered_[row] -= lower_upper_(row, column) * known;
  }
  x = ordered_;
}

}  // namespace hybridtest
