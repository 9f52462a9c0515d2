#include "experimental_site/geometry/setup_geometry.hpp"

#include <Eigen/QR>

namespace hybridtest {
namespace {

constexpr int kIterations = 20;
/// [m] and [rad]: a thousandth of the resolution of the best transducers.
constexpr double kTolerance = 1e-12;

}  // namespace

bool find_pose(const SetupGeometry& geometry, const SiteVector& stroke_m, SiteVector& pose) noexcept {
  SiteVector found = pose;
  SiteVector difference_m = stroke_m;
  SiteMatrix jacobian{geometry.actuators(), geometry.dofs()};
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    geometry.strokes(found, difference_m);
    difference_m = stroke_m - difference_m;
    geometry.derivative(found, jacobian);
    if (!difference_m.allFinite() || !jacobian.allFinite()) return false;
    const Eigen::ColPivHouseholderQR<SiteMatrix> factors{jacobian};
    if (factors.rank() < geometry.dofs()) return false;
    const SiteVector step = factors.solve(difference_m);
    // Differences below the tolerance are ignored, so that strokes at rest give exactly the pose at rest.
    if (step.cwiseAbs().maxCoeff() <= kTolerance) {
      pose = found;
      return true;
    }
    found += step;
  }
  return false;
}

void transfer_forces(const SetupGeometry& geometry, const SiteVector& pose, const SiteVector& force_n,
                     SiteVector& dof_force) noexcept {
  SiteMatrix jacobian{geometry.actuators(), geometry.dofs()};
  geometry.derivative(pose, jacobian);
  // lazyProduct() allocates no buffer.
  dof_force.noalias() = jacobian.transpose().lazyProduct(force_n);
}

}  // namespace hybridtest
