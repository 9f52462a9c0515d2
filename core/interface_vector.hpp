#pragma once

#include <Eigen/Core>

namespace hybridtest {

/// Most interface degrees of freedom of a numerical substructure; bounds what a message may hold.
inline constexpr int kMaxInterfaceDofs = 2048;

/// Most interface degrees of freedom of an experimental site. Fixed, so that the control path never allocates.
inline constexpr int kMaxSiteDofs = 12;

/// One value per interface degree of freedom of any substructure. Copying one into another of the same size does not
/// allocate.
using InterfaceVector = Eigen::VectorXd;

/// Interface by interface.
using InterfaceMatrix = Eigen::MatrixXd;

/// One value per interface degree of freedom of a site; no heap.
using SiteVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxSiteDofs, 1>;

/// Interface by interface of a site, for stiffness and geometry; no heap.
using SiteMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxSiteDofs, kMaxSiteDofs>;

}  // namespace hybridtest
