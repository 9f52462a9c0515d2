#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mechanics/structure/linear_structure.hpp"
#include "mechanics/structure/vibration_modes.hpp"

namespace hybridtest {

/// An experimental site as its linear specimen, for estimates before the test. With p interface
/// degrees of freedom in a structure of n, the specimen answers B (M_e a + C_e v + K_e u) with
/// u = B^T (displacements of the structure).
struct CoupledSite {
  std::string id;
  Eigen::MatrixXd interface;          // B, n x p: +1 at the degree of freedom, -1 at what it is relative to
  Eigen::MatrixXd stiffness_n_per_m;  // K_e, p x p
  Eigen::MatrixXd damping_n_s_per_m;  // C_e, p x p; empty for none
  Eigen::MatrixXd mass_kg;            // M_e, p x p; empty for none
};

/// B of one interface: column k is +1 at `degrees_of_freedom[k]` and -1 at `relative_to[k]`
/// unless that is negative, which stands for the ground.
/// @throws ConfigError for a degree of freedom that the structure does not have.
[[nodiscard]] Eigen::MatrixXd interface_matrix(Eigen::Index structure_size, const std::vector<int>& degrees_of_freedom,
                                               const std::vector<int>& relative_to);

/// Sizes that fit the structure and each other, finite numbers.
/// @throws ConfigError naming the site.
void require_consistent(const LinearStructure& structure, const CoupledSite& site);

/// How much of the structure's stiffness the site holds, mode by mode: the strain energy in the
/// specimen over that of the whole structure, phi^T B K_e B^T phi / phi^T K phi, 0 to 1; not a
/// number for a motion without stiffness. The larger, the more a delay at the site matters.
[[nodiscard]] Eigen::VectorXd stiffness_share_by_mode(const LinearStructure& structure, const VibrationModes& modes,
                                                      const CoupledSite& site);

/// What a delay tau of the site's force is to the structure, to first order in tau: damping of
/// -K_e tau (Horiuchi et al., 1999). p x p.
[[nodiscard]] Eigen::MatrixXd equivalent_damping_n_s_per_m(const CoupledSite& site, double delay_s);

/// The same as a damping ratio of each mode, -tau phi^T B K_e B^T phi / (2 omega), to be added to
/// damping_ratios(); 0 for a motion without stiffness.
[[nodiscard]] Eigen::VectorXd equivalent_damping_ratios(const VibrationModes& modes, const CoupledSite& site,
                                                        double delay_s);

}  // namespace hybridtest
