#include "experimental_site/geometry/rigid_beam.hpp"

#include <cmath>
#include <string>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

/// [m] Below this lever arm the actuators do not hold the rotation.
constexpr double kArm_m_min = 1e-6;

}  // namespace

RigidBeam::RigidBeam(const std::array<Actuator, 2>& actuators) : actuators_{actuators} {
  for (std::size_t i = 0; i < actuators_.size(); ++i) {
    length_at_rest_m_[i] = (actuators_[i].attachment_m - actuators_[i].anchor_m).norm();
    if (!(length_at_rest_m_[i] > kArm_m_min) || !std::isfinite(length_at_rest_m_[i])) {
      throw ConfigError{"actuator " + std::to_string(i + 1) +
                        " of the rigid beam has no length: its anchor and its attachment are the same point"};
    }
  }
  SiteMatrix jacobian{2, 2};
  derivative(SiteVector::Zero(2), jacobian);
  const double determinant_m = jacobian(0, 0) * jacobian(1, 1) - jacobian(0, 1) * jacobian(1, 0);
  if (!(std::abs(determinant_m) > kArm_m_min)) {
    throw ConfigError{
        "the two actuators of the rigid beam act along one line or across the displacement: together they do not hold "
        "displacement and rotation"};
  }
}

void RigidBeam::strokes(const SiteVector& pose, SiteVector& stroke_m) const noexcept {
  for (std::size_t i = 0; i < actuators_.size(); ++i) {
    stroke_m[static_cast<Eigen::Index>(i)] = chord(actuators_[i], pose).norm() - length_at_rest_m_[i];
  }
}

void RigidBeam::derivative(const SiteVector& pose, SiteMatrix& jacobian) const noexcept {
  const double cosine = std::cos(pose[1]);
  const double sine = std::sin(pose[1]);
  for (std::size_t i = 0; i < actuators_.size(); ++i) {
    const Eigen::Vector2d direction = chord(actuators_[i], pose).normalized();
    const Eigen::Vector2d& a = actuators_[i].attachment_m;
    const Eigen::Vector2d per_rotation{-sine * a.x() - cosine * a.y(), cosine * a.x() - sine * a.y()};
    const auto row = static_cast<Eigen::Index>(i);
    jacobian(row, 0) = direction.x();
    jacobian(row, 1) = direction.dot(per_rotation);
  }
}

Eigen::Vector2d RigidBeam::chord(const Actuator& actuator, const SiteVector& pose) noexcept {
  const double cosine = std::cos(pose[1]);
  const double sine = std::sin(pose[1]);
  const Eigen::Vector2d& a = actuator.attachment_m;
  const Eigen::Vector2d turned{cosine * a.x() - sine * a.y(), sine * a.x() + cosine * a.y()};
  return Eigen::Vector2d{pose[0], 0.0} + turned - actuator.anchor_m;
}

}  // namespace hybridtest
