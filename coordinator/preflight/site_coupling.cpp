#include "coordinator/preflight/site_coupling.hpp"

#include <limits>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

void check_square(const CoupledSite& site, const Eigen::MatrixXd& matrix, const std::string& name, bool may_be_empty) {
  if (may_be_empty && matrix.size() == 0) return;
  const Eigen::Index size = site.interface.size();
  if (matrix.rows() != size || matrix.cols() != size) {
    throw ConfigError{"site '" + site.id + "': the " + name + " of the specimen is " + std::to_string(matrix.rows()) +
                      " by " + std::to_string(matrix.cols()) + ", expected " + std::to_string(size) + " by " +
                      std::to_string(size) + ", one row and column per interface degree of freedom"};
  }
  if (!matrix.allFinite()) {
    throw ConfigError{"site '" + site.id + "': the " + name + " of the specimen holds a number that is not finite"};
  }
}

/// Of one mode: phi^T B^T K_e B phi.
double specimen_stiffness(const CoupledSite& site, const Eigen::Ref<const Eigen::VectorXd>& shape) {
  InterfaceVector deformation;
  site.interface.to_interface(shape, deformation);
  return deformation.dot(site.stiffness_n_per_m * deformation);
}

}  // namespace

void require_consistent(const LinearStructure& structure, const CoupledSite& site) {
  if (site.interface.structure_size() != structure.size() || site.interface.size() == 0) {
    throw ConfigError{"site '" + site.id + "': the interface has " + std::to_string(site.interface.size()) +
                      " degrees of freedom in a structure of " + std::to_string(site.interface.structure_size()) +
                      ", expected at least one in a structure of " + std::to_string(structure.size())};
  }
  check_square(site, site.stiffness_n_per_m, "stiffness", false);
  check_square(site, site.damping_n_s_per_m, "damping", true);
  check_square(site, site.mass_kg, "mass", true);
}

Eigen::VectorXd stiffness_share_by_mode(const LinearStructure& structure, const VibrationModes& modes,
                                        const CoupledSite& site) {
  require_consistent(structure, site);
  Eigen::VectorXd share{modes.count()};
  for (Eigen::Index mode = 0; mode < modes.count(); ++mode) {
    const auto shape = modes.shapes.col(mode);
    const double total = shape.dot(structure.initial_stiffness_n_per_m * shape);
    const bool has_stiffness = modes.frequency_rad_per_s[mode] > 0.0;
    share[mode] = has_stiffness ? specimen_stiffness(site, shape) / total : std::numeric_limits<double>::quiet_NaN();
  }
  return share;
}

}  // namespace hybridtest
