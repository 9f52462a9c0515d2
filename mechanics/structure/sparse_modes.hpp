#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace hybridtest {

/// Some solutions of K phi = lambda M phi of large sparse matrices, K symmetric, M positive definite.
struct Eigenpairs {
  Eigen::VectorXd values;   // lowest first
  Eigen::MatrixXd vectors;  // one column each, phi^T M phi = 1
};

/// Largest lambda from above: at most a few times 1e-4 of itself too high, so that a stability limit taken from it
/// is safe. A Lanczos estimate, then the inertia of K - sigma M (Sylvester), which has no eigenvalue above sigma when
/// none of its pivots is positive (Parlett, The Symmetric Eigenvalue Problem, 1998, sections 3.3 and 13). 0 where no
/// motion has stiffness.
[[nodiscard]] double largest_eigenvalue(const Eigen::SparseMatrix<double>& stiffness,
                                        const Eigen::SparseMatrix<double>& mass);

/// The `count` lowest ones, by Lanczos on the inverse of K - sigma M (Ericsson and Ruhe, 1980), sigma just below
/// zero. @param count     1 to below the size.
/// @param largest   as largest_eigenvalue(), for the scale.
/// @throws ConfigError when the stiffness is negative in some motion, and when Lanczos does not converge.
[[nodiscard]] Eigenpairs lowest_eigenpairs(const Eigen::SparseMatrix<double>& stiffness,
                                           const Eigen::SparseMatrix<double>& mass, Eigen::Index count, double largest);

}  // namespace hybridtest
