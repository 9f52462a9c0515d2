#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <string>

namespace hybridtest {

/// A sparse matrix taken apart once, to solve A x = b in every step without allocating.
///
/// Diagonal matrices are divided by; symmetric ones go through a sparse L D L^T with a
/// fill-reducing order (Davis, Direct Methods for Sparse Linear Systems, 2006); the rest, which
/// only unsymmetric damping brings, through a dense LU with partial pivoting. The triangular
/// solves are written out here because those of the sparse library allocate temporaries.
class FactorisedMatrix {
 public:
  /// @param name   of the matrix, for messages.
  /// @throws ConfigError when the matrix is singular; when a symmetric one is not positive
  ///         definite; when an unsymmetric one has more than kMaxUnsymmetricSize rows.
  FactorisedMatrix(const Eigen::SparseMatrix<double>& matrix, const std::string& name);

  /// Dense LU storage grows with the square of the size.
  static constexpr Eigen::Index kMaxUnsymmetricSize = 2000;

  /// Puts the solution in place of the right-hand side; one entry per row. Not for two threads
  /// at once: uses a buffer of its own.
  void solve_in_place(Eigen::VectorXd& right_hand_side) noexcept;

 private:
  enum class Kind { diagonal, symmetric, unsymmetric };

  void factorise_symmetric(const Eigen::SparseMatrix<double>& matrix, const std::string& name);
  void factorise_unsymmetric(const Eigen::SparseMatrix<double>& matrix, const std::string& name);
  void solve_symmetric(Eigen::VectorXd& x) noexcept;
  void solve_unsymmetric(Eigen::VectorXd& x) noexcept;

  Kind kind_ = Kind::diagonal;
  Eigen::VectorXd diagonal_;           // of the matrix, or D of L D L^T
  Eigen::SparseMatrix<double> lower_;  // L, its unit diagonal left out
  Eigen::MatrixXd lower_upper_;        // both triangles of the dense LU
  Eigen::VectorXi order_;              // row i of the factors is row order_[i] of the matrix
  Eigen::VectorXd ordered_;            // buffer
};

}  // namespace hybridtest
