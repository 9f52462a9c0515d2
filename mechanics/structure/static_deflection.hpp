#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

namespace hybridtest {

/// The structure at rest where some degrees of freedom are held at given displacements and no force acts on the others:
/// u_f = -K_ff^-1 K_fg u_g.
/// @param stiffness_n_per_m   n x n, symmetric.
/// @param given               rows whose entries of `displacement_m` stand; each once.
/// @param displacement_m      n entries; those that are not given do not matter.
/// @throws ConfigError when the others are not held: K_ff is singular or not positive definite.
[[nodiscard]] Eigen::VectorXd static_deflection(const Eigen::SparseMatrix<double>& stiffness_n_per_m,
                                                const std::vector<Eigen::Index>& given,
                                                const Eigen::VectorXd& displacement_m);

}  // namespace hybridtest
