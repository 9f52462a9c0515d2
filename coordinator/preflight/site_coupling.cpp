#include "coordinator/preflight/site_coupling.hpp"

#include <cstddef>
#include <limits>
#include <utility>

#include "core/assert.hpp"
#include "core/config_error.hpp"

namespace hybridtest {
namespace {

void check_square(const CoupledSite& site, const Eigen::MatrixXd& matrix, const std::string& name, bool may_be_empty) {
  if (may_be_empty && matrix.size() == 0) return;
  const Eigen::Index size = site.interface.cols();
  if (matrix.rows() != size || matrix.cols() != size) {
    throw ConfigError{"site '" + site.id + "': the " + name + " of the specimen is " + std::to_string(matrix.rows()) +
                      " by " + std::to_string(matrix.cols()) + ", expected " + std::to_string(size) + " by " +
                      std::to_string(size) + ", one row and column per interface degree of freedom"};
  }
  if (!matrix.allFinite()) {
    throw ConfigError{"site '" + site.id + "': the " + name + " of the specimen holds a number that is not finite"};
  }
}

/// Of one mode: phi^T B K_e B^T phi.
double specimen_stiffness(const CoupledSite& site, const Eigen::Ref<const Eigen::VectorXd>& shape) {
  const Eigen::VectorXd deformation = site.interface.transpose() * shape;
  return deformation.dot(site.stiffness_n_per_m * deformation);
}

}  // namespace

Eigen::MatrixXd interface_matrix(Eigen::Index structure_size, const std::vector<int>& degrees_of_freedom,
                                 const std::vector<int>& relative_to) {
  HYBRIDTEST_ASSERT(degrees_of_freedom.size() == relative_to.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(structure_size, static_cast<Eigen::Index>(degrees_of_freedom.size()));
  for (std::size_t k = 0; k < degrees_of_freedom.size(); ++k) {
    const int dof = degrees_of_freedom[k];
    const int base = relative_to[k];
    if (dof < 0 || dof >= structure_size || base >= structure_size || base == dof) {
      throw ConfigError{"interface degree of freedom " + std::to_string(k + 1) + " is " + std::to_string(dof) +
                        " relative to " + std::to_string(base) + ", expected two different ones of 0 to " +
                        std::to_string(structure_size - 1)};
    }
    matrix(dof, static_cast<Eigen::Index>(k)) = 1.0;
    if (base >= 0) matrix(base, static_cast<Eigen::Index>(k)) = -1.0;
  }
  return matrix;
}

void require_consistent(const LinearStructure& structure, const CoupledSite& site) {
  if (site.interface.rows() != structure.size() || site.interface.cols() == 0 || !site.interface.allFinite()) {
    throw ConfigError{"site '" + site.id + "': the interface matrix is " + std::to_string(site.interface.rows()) +
                      " by " + std::to_string(site.interface.cols()) + ", expected " +
                      std::to_string(structure.size()) +
                      " rows, one per degree of freedom, and one column per interface degree of freedom"};
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

Eigen::MatrixXd equivalent_damping_n_s_per_m(const CoupledSite& site, double delay_s) {
  return -delay_s * site.stiffness_n_per_m;
}

Eigen::VectorXd equivalent_damping_ratios(const VibrationModes& modes, const CoupledSite& site, double delay_s) {
  Eigen::VectorXd ratios = Eigen::VectorXd::Zero(modes.count());
  for (Eigen::Index mode = 0; mode < modes.count(); ++mode) {
    const double omega = modes.frequency_rad_per_s[mode];
    if (omega <= 0.0) continue;
    ratios[mode] = -delay_s * specimen_stiffness(site, modes.shapes.col(mode)) / (2.0 * omega);
  }
  return ratios;
}

}  // namespace hybridtest
