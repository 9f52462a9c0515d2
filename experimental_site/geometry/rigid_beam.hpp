#pragma once

#include <Eigen/Core>
#include <array>

#include "experimental_site/geometry/setup_geometry.hpp"

namespace hybridtest {

/// Two actuators on a rigid loading beam in a plane, at any displacement and rotation.
///
/// Two degrees of freedom: the displacement u [m] of a reference point along x, and the rotation
/// theta [rad] about it, positive from x to y. The reference point is guided: it does not move along y. An
/// actuator reaches from its anchor b on the reaction wall to its attachment a on the beam, both from the
/// reference point at rest. Exact for a rigid beam and pins without play:
///
///     stroke = |(u, 0) + R(theta) a - b| - |a - b|
///
/// docs/setup_geometry.svg
class RigidBeam final : public SetupGeometry {
 public:
  struct Actuator {
    Eigen::Vector2d attachment_m;  // [m] on the beam, at rest, from the reference point
    Eigen::Vector2d anchor_m;      // [m] on the reaction wall, from the reference point at rest
  };

  /// @throws ConfigError for an actuator without length, and where both together leave a degree of freedom free
  ///         at rest, such as when they act along one line.
  explicit RigidBeam(const std::array<Actuator, 2>& actuators);

  [[nodiscard]] int dofs() const noexcept override { return 2; }
  [[nodiscard]] int actuators() const noexcept override { return 2; }
  void strokes(const SiteVector& pose, SiteVector& stroke_m) const noexcept override;
  void derivative(const SiteVector& pose, SiteMatrix& jacobian) const noexcept override;

 private:
  /// From anchor to attachment.
  [[nodiscard]] static Eigen::Vector2d chord(const Actuator& actuator, const SiteVector& pose) noexcept;

  std::array<Actuator, 2> actuators_;
  std::array<double, 2> length_at_rest_m_{};
};

}  // namespace hybridtest
