#pragma once

#include <Eigen/Core>

#include "experimental_site/geometry/setup_geometry.hpp"

namespace hybridtest {

/// Linear geometry, for small displacements, levers and parallel actuators: stroke = matrix * pose.
class LinearGeometry final : public SetupGeometry {
 public:
  /// @param matrix   actuators by degrees of freedom; [-], and [m] for rotations.
  /// @throws ConfigError for more than kMaxSiteDofs actuators, for fewer actuators than degrees of
  ///         freedom, and where the actuators leave a degree of freedom free.
  explicit LinearGeometry(const Eigen::MatrixXd& matrix);

  [[nodiscard]] int dofs() const noexcept override { return static_cast<int>(matrix_.cols()); }
  [[nodiscard]] int actuators() const noexcept override { return static_cast<int>(matrix_.rows()); }
  void strokes(const SiteVector& pose, SiteVector& stroke_m) const noexcept override;
  void derivative(const SiteVector& pose, SiteMatrix& jacobian) const noexcept override;

 private:
  SiteMatrix matrix_;
};

}  // namespace hybridtest
