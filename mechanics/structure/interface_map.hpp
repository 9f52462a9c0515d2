#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "core/interface_vector.hpp"

namespace hybridtest {

/// One interface degree of freedom: the displacement of a structure degree of freedom, absolute
/// (against the ground) or relative to another one.
struct InterfaceDof {
  static constexpr int kGround = -1;
  int dof = 0;
  int relative_to = kGround;
};

/// B of one substructure, p x n: interface displacement = B (structure displacement), and structure
/// force += B^T (interface force). Row k of B has +1 at `dof` and -1 at `relative_to`, so that both
/// products cost two operations per interface degree of freedom. They conserve work:
/// f . (B u) = (B^T f) . u.
///
/// The products are safe on the real-time path: they do not allocate.
class InterfaceMap {
 public:
  /// No interface degree of freedom.
  InterfaceMap() = default;
  /// @param structure_size   n, degrees of freedom of the structure.
  /// @param dofs             p of them, at most kMaxInterfaceDofs.
  /// @throws ConfigError for too many of them, for a degree of freedom that the structure does not
  ///         have, and for one relative to itself.
  InterfaceMap(Eigen::Index structure_size, std::vector<InterfaceDof> dofs);

  /// p, interface degrees of freedom.
  [[nodiscard]] Eigen::Index size() const noexcept { return static_cast<Eigen::Index>(dofs_.size()); }
  /// n, structure degrees of freedom.
  [[nodiscard]] Eigen::Index structure_size() const noexcept { return structure_size_; }
  [[nodiscard]] const std::vector<InterfaceDof>& dofs() const noexcept { return dofs_; }
  /// The column of B for this structure degree of freedom is not zero.
  [[nodiscard]] bool uses(Eigen::Index structure_dof) const noexcept;

  /// B x, for displacements, velocities or accelerations. Sets the size of `interface` to p.
  /// @param structure   n values.
  void to_interface(const Eigen::Ref<const Eigen::VectorXd>& structure, InterfaceVector& interface) const noexcept;

  /// structure_n += B^T interface_n, one interface degree of freedom after the other.
  /// @param interface_n   p forces.
  /// @param structure_n   n forces.
  void add_to_structure(const Eigen::Ref<const Eigen::VectorXd>& interface_n,
                        Eigen::Ref<Eigen::VectorXd> structure_n) const noexcept;

  /// B^T K_s B: a stiffness over the interface as one of the structure, n x n.
  /// @param interface_n_per_m   p x p.
  [[nodiscard]] Eigen::SparseMatrix<double> on_structure(const Eigen::MatrixXd& interface_n_per_m) const;

  /// B as a dense matrix, p x n.
  [[nodiscard]] Eigen::MatrixXd matrix() const;

 private:
  Eigen::Index structure_size_ = 0;
  std::vector<InterfaceDof> dofs_;
};

}  // namespace hybridtest
