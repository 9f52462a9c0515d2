#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <optional>

namespace hybridtest {

/// Energy of a structure since its first step [J], relative to the ground (Chopra, Dynamics of Structures, section 7.9;
/// Uang and Bertero, 1990).
struct StructureEnergy {
  double kinetic_j = 0.0;    // v^T M v / 2
  double damping_j = 0.0;    // dissipated by C
  double restoring_j = 0.0;  // stored in and dissipated by K and the substructures
  double input_j = 0.0;      // work of the loads, and the kinetic energy of the first step

  /// What the balance misses: of the integration in time and of forces that the structure did not feel as they were.
  [[nodiscard]] double error_j() const noexcept { return kinetic_j + damping_j + restoring_j - input_j; }
};

/// Adds up the energy of a recorded motion, step by step, by the trapezoidal rule: work of a force over a step is its
/// mean times the increment of displacement. Exact for average acceleration; of second order in the step otherwise.
class EnergyBalance {
 public:
  /// @param mass_kg, damping_n_s_per_m   n x n.
  EnergyBalance(const Eigen::SparseMatrix<double>& mass_kg, const Eigen::SparseMatrix<double>& damping_n_s_per_m);

  /// @param displacement_m, velocity_m_per_s, restoring_force_n, applied_force_n   n entries each, at one step; forces
  ///        are positive the same way as displacements, the restoring force when it resists a positive displacement.
  void add(const Eigen::Ref<const Eigen::VectorXd>& displacement_m,
           const Eigen::Ref<const Eigen::VectorXd>& velocity_m_per_s,
           const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
           const Eigen::Ref<const Eigen::VectorXd>& applied_force_n);

  /// All zero before the first step.
  [[nodiscard]] const StructureEnergy& energy() const noexcept { return energy_; }

 private:
  struct Forces {
    Eigen::VectorXd displacement_m;
    Eigen::VectorXd damping_n;
    Eigen::VectorXd restoring_n;
    Eigen::VectorXd applied_n;
  };

  Eigen::SparseMatrix<double> mass_kg_;
  Eigen::SparseMatrix<double> damping_n_s_per_m_;
  std::optional<Forces> before_;
  StructureEnergy energy_;
};

}  // namespace hybridtest
