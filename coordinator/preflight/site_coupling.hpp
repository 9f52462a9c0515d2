#pragma once

#include <Eigen/Core>
#include <string>

#include "mechanics/structure/interface_map.hpp"
#include "mechanics/structure/linear_structure.hpp"
#include "mechanics/structure/vibration_modes.hpp"

namespace hybridtest {

/// An experimental site as its linear specimen, for estimates before the test. With p interface
/// degrees of freedom in a structure of n, the force of the specimen on the structure is
/// B^T (M_e a + C_e v + K_e u) with u = B (displacements of the structure).
struct CoupledSite {
  std::string id;
  InterfaceMap interface;             // B, p x n
  Eigen::MatrixXd stiffness_n_per_m;  // K_e, p x p
  Eigen::MatrixXd damping_n_s_per_m;  // C_e, p x p; empty for none
  Eigen::MatrixXd mass_kg;            // M_e, p x p; empty for none
};

/// Sizes that fit the structure and each other, finite numbers.
/// @throws ConfigError naming the site.
void require_consistent(const LinearStructure& structure, const CoupledSite& site);

/// Stiffness share of the site in each mode: the strain energy in the specimen over that of the whole
/// structure, phi^T B^T K_e B phi / phi^T K phi, 0 to 1; NaN for a mode without stiffness. The larger
/// the share, the larger the effect of a delay at the site.
[[nodiscard]] Eigen::VectorXd stiffness_share_by_mode(const LinearStructure& structure, const VibrationModes& modes,
                                                      const CoupledSite& site);

}  // namespace hybridtest
