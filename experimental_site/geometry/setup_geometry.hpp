#pragma once

#include "core/interface_vector.hpp"

namespace hybridtest {

/// Placement of the actuators of a site: maps interface degrees of freedom to strokes.
///
/// A pose holds the displacements [m] and rotations [rad] of the degrees of freedom, zero at rest. A
/// stroke [m] is the length of an actuator minus its length at rest. At least as many actuators as
/// degrees of freedom. Allocates nothing after construction.
class SetupGeometry {
 public:
  virtual ~SetupGeometry() = default;

  [[nodiscard]] virtual int dofs() const noexcept = 0;
  [[nodiscard]] virtual int actuators() const noexcept = 0;
  /// @param stroke_m   sized actuators() by the caller.
  virtual void strokes(const SiteVector& pose, SiteVector& stroke_m) const noexcept = 0;
  /// Derivative of the strokes by the pose.
  /// @param jacobian   sized actuators() by dofs() by the caller; [-] and [m] for rotations.
  virtual void derivative(const SiteVector& pose, SiteMatrix& jacobian) const noexcept = 0;
};

/// The pose that belongs to measured strokes: Gauss-Newton iteration from a nearby pose, at most 20 steps.
/// With more actuators than degrees of freedom, the pose with the least sum of squared stroke differences.
/// @param pose   in: a nearby pose, such as that of the previous sample. Out: exact to 1e-12 m or rad;
///               unchanged when not found.
/// @return false when not found: no pose has these strokes, a number is not finite, or the actuators do not
///         hold the degrees of freedom in that pose.
[[nodiscard]] bool find_pose(const SetupGeometry& geometry, const SiteVector& stroke_m, SiteVector& pose) noexcept;

/// Forces [N] and moments [N m] at the degrees of freedom, by virtual work: the transposed derivative at the
/// pose times the actuator forces.
/// @param dof_force   sized dofs() by the caller.
void transfer_forces(const SetupGeometry& geometry, const SiteVector& pose, const SiteVector& force_n,
                     SiteVector& dof_force) noexcept;

}  // namespace hybridtest
