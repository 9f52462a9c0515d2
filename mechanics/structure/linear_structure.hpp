#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <string>
#include <vector>

namespace hybridtest {

/// The linear part of the equation of motion, M a + C v + K u + r(u) = -M iota a_g, with r of the
/// substructures, and the stiffness that K u + r(u) starts with. Forces and displacements are positive the same way.
struct LinearStructure {
  std::vector<std::string> degrees_of_freedom;            // names, for messages
  Eigen::SparseMatrix<double> mass_kg;                    // n x n, symmetric, positive definite
  Eigen::SparseMatrix<double> damping_n_s_per_m;          // n x n
  Eigen::SparseMatrix<double> stiffness_n_per_m;          // K, n x n, symmetric; empty when substructures have it all
  Eigen::SparseMatrix<double> initial_stiffness_n_per_m;  // n x n, symmetric; K and all substructures together
  Eigen::VectorXd influence;                              // iota: displacement per unit ground displacement

  [[nodiscard]] Eigen::Index size() const noexcept { return mass_kg.rows(); }

  /// Load on each degree of freedom per unit of ground acceleration, -M iota [kg].
  [[nodiscard]] Eigen::VectorXd load_per_ground_acceleration_kg() const;
};

/// Sizes that fit each other, finite numbers, symmetric mass and stiffness, positive definite
/// mass: what the explicit integrators and the modal analysis need.
/// @throws ConfigError listing everything that is wrong, by names of degrees of freedom.
void require_consistent(const LinearStructure& structure);

/// Mass and stiffness equal their transposes.
/// @throws ConfigError naming the first entries of each that do not.
void require_symmetric(const LinearStructure& structure);

/// Of the degree of freedom for messages: its name in quotes or, without one, its number.
[[nodiscard]] std::string dof_name(const LinearStructure& structure, Eigen::Index dof);

}  // namespace hybridtest
