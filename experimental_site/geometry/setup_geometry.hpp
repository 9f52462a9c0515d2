#pragma once

#include "core/interface_vector.hpp"

namespace hybridtest {

/// How the actuators of a site are placed: from interface degrees of freedom to strokes.
///
/// A pose is the displacements [m] and rotations [rad] of the degrees of freedom, zero at rest. A
/// stroke [m] is by how much an actuator is longer than at rest. At least as many actuators as
/// degrees of freedom. Allocates nothing after construction.
class SetupGeometry {
 public:
  virtual ~SetupGeometry() = default;

  [[nodiscard]] virtual int dofs() const noexcept = 0;
  [[nodiscard]] virtual int actuators() const noexcept = 0;
  /// @param stroke_m   sized actuators() by the caller.
  virtual void strokes(const InterfaceVector& pose, InterfaceVector& stroke_m) const noexcept = 0;
  /// Derivative of the strokes by the pose.
  /// @param jacobian   sized actuators() by dofs() by the caller; [-] and [m] for rotations.
  virtual void derivative(const InterfaceVector& pose, InterfaceMatrix& jacobian) const noexcept = 0;
};

/// The pose that measured strokes mean: Gauss-Newton from a pose nearby, at most 20 iterations. With more
/// actuators than degrees of freedom the one with the least sum of squared stroke differences.
/// @param pose   in: nearby, such as at the sample before. Out: within 1e-12 m or rad; unchanged when not found.
/// @return false when it was not found: strokes that no pose has, numbers that are none, or a pose in which
///         the actuators do not hold the degrees of freedom.
[[nodiscard]] bool find_pose(const SetupGeometry& geometry, const InterfaceVector& stroke_m,
                             InterfaceVector& pose) noexcept;

/// Forces [N] and moments [N m] at the degrees of freedom that do the virtual work of the actuators' forces:
/// derivative at the pose, transposed, times the forces.
/// @param dof_force   sized dofs() by the caller.
void transfer_forces(const SetupGeometry& geometry, const InterfaceVector& pose, const InterfaceVector& force_n,
                     InterfaceVector& dof_force) noexcept;

}  // namespace hybridtest
