#pragma once

#include <Eigen/Core>
#include <complex>

#include "mechanics/structure/interface_map.hpp"

namespace hybridtest {

/// M a + C v + K u = f, dense.
struct DenseSystem {
  Eigen::MatrixXd mass_kg;
  Eigen::MatrixXd damping_n_s_per_m;
  Eigen::MatrixXd stiffness_n_per_m;
};

/// Poles of the system, two per degree of freedom.
[[nodiscard]] Eigen::VectorXcd poles_rad_per_s(const DenseSystem& system);

/// Frequency response of a closed loop of a structure and one substructure, opened at the force:
/// S(iw) B (K - w^2 M + iw C)^-1 B^T, p x p, with S of the substructure and the rest of the
/// structure. One Schur decomposition at construction; each frequency then costs a triangular
/// solve instead of a factorisation.
class LoopTransfer {
 public:
  /// @param structure      without the substructure; positive definite mass.
  /// @param substructure   p x p matrices.
  /// @param interface      B, p x n.
  LoopTransfer(const DenseSystem& structure, DenseSystem substructure, const InterfaceMap& interface);

  /// Of the structure without the substructure.
  [[nodiscard]] const Eigen::VectorXcd& structure_poles_rad_per_s() const noexcept { return poles_; }

  /// Eigenvalues of the transfer matrix, largest modulus first.
  [[nodiscard]] Eigen::VectorXcd eigenvalues(double frequency_rad_per_s) const;

  /// The same in the limit of infinite frequency: of M_e B M^-1 B^T.
  [[nodiscard]] double modulus_at_infinity_max() const;

 private:
  DenseSystem substructure_;
  double reference_rad_per_s_ = 1.0;  // scales the displacement states to the magnitude of velocities
  Eigen::MatrixXcd triangular_;       // Schur form of the state matrix
  Eigen::MatrixXcd input_;            // 2n x p, in Schur coordinates
  Eigen::MatrixXcd output_;           // p x 2n, in Schur coordinates
  Eigen::VectorXcd poles_;
  Eigen::MatrixXd flexibility_at_infinity_;  // B M^-1 B^T
};

}  // namespace hybridtest
