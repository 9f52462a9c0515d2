#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "mechanics/structure/linear_structure.hpp"

/// Structures that several tests use.
namespace hybridtest::test {

inline LinearStructure structure_of(const Eigen::MatrixXd& mass_kg, const Eigen::MatrixXd& damping_n_s_per_m,
                                    const Eigen::MatrixXd& stiffness_n_per_m) {
  LinearStructure structure;
  structure.mass_kg = mass_kg.sparseView();
  structure.damping_n_s_per_m = damping_n_s_per_m.sparseView();
  structure.initial_stiffness_n_per_m = stiffness_n_per_m.sparseView();
  structure.influence = Eigen::VectorXd::Ones(mass_kg.rows());
  return structure;
}

inline LinearStructure oscillator(double mass_kg, double damping_n_s_per_m, double stiffness_n_per_m) {
  return structure_of(Eigen::MatrixXd::Constant(1, 1, mass_kg), Eigen::MatrixXd::Constant(1, 1, damping_n_s_per_m),
                      Eigen::MatrixXd::Constant(1, 1, stiffness_n_per_m));
}

/// Equal storeys, fixed at the ground, free at the top.
inline LinearStructure shear_building(int storeys, double mass_kg, double stiffness_n_per_m) {
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(storeys, storeys);
  for (int storey = 0; storey < storeys; ++storey) {
    stiffness(storey, storey) += stiffness_n_per_m;
    if (storey == 0) continue;
    stiffness(storey - 1, storey - 1) += stiffness_n_per_m;
    stiffness(storey - 1, storey) -= stiffness_n_per_m;
    stiffness(storey, storey - 1) -= stiffness_n_per_m;
  }
  return structure_of(mass_kg * Eigen::MatrixXd::Identity(storeys, storeys), Eigen::MatrixXd::Zero(storeys, storeys),
                      stiffness);
}

/// The model of the reference time histories: two floors of 20 t, storeys of 4.0 and 3.0 MN/m.
inline LinearStructure two_storeys() {
  Eigen::MatrixXd stiffness(2, 2);
  stiffness << 7.0e6, -3.0e6, -3.0e6, 3.0e6;
  LinearStructure structure =
      structure_of(20.0e3 * Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd::Zero(2, 2), stiffness);
  structure.degrees_of_freedom = {"floor_1", "floor_2"};
  return structure;
}

/// A symmetric positive definite matrix, full.
inline Eigen::MatrixXd random_definite_matrix(int size, Random& random) {
  Eigen::MatrixXd factor(size, size);
  for (double& entry : factor.reshaped()) entry = random.uniform(-1.0, 1.0);
  return factor * factor.transpose() + static_cast<double>(size) * Eigen::MatrixXd::Identity(size, size);
}

}  // namespace hybridtest::test
