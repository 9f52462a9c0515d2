#include "experimental_site/geometry/linear_geometry.hpp"

#include <Eigen/QR>
#include <string>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

SiteMatrix checked_matrix(const Eigen::MatrixXd& matrix) {
  const auto size = std::to_string(matrix.rows()) + " actuators for " + std::to_string(matrix.cols()) +
                    " interface degrees of freedom";
  if (matrix.cols() < 1 || matrix.rows() < matrix.cols() || matrix.rows() > kMaxSiteDofs) {
    throw ConfigError{"a geometry of " + size + "; expected at least as many actuators, at most " +
                      std::to_string(kMaxSiteDofs)};
  }
  if (!matrix.allFinite()) throw ConfigError{"the matrix of the geometry holds a number that is not finite"};
  if (matrix.colPivHouseholderQr().rank() < matrix.cols()) {
    throw ConfigError{"a geometry of " + size +
                      " does not determine every degree of freedom: its columns are linearly dependent"};
  }
  return matrix;
}

}  // namespace

LinearGeometry::LinearGeometry(const Eigen::MatrixXd& matrix) : matrix_{checked_matrix(matrix)} {}

void LinearGeometry::strokes(const SiteVector& pose, SiteVector& stroke_m) const noexcept {
  stroke_m.noalias() = matrix_.lazyProduct(pose);
}

void LinearGeometry::derivative(const SiteVector& /*pose*/, SiteMatrix& jacobian) const noexcept { jacobian = matrix_; }

}  // namespace hybridtest
