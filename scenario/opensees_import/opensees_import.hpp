#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mechanics/structure/linear_structure.hpp"
#include "scenario/dof_table.hpp"

namespace hybridtest {

/// Units of a script, in SI; time is in seconds.
struct ModelUnits {
  double length_m = 1.0;
  double force_n = 1.0;
};

/// Names of units on the command line: m, mm, cm, in, ft; N, kN, MN, lbf, kip, kgf, tf.
[[nodiscard]] const std::vector<std::string>& length_unit_names();
[[nodiscard]] const std::vector<std::string>& force_unit_names();
/// Both are one of the names.
[[nodiscard]] ModelUnits model_units(std::string_view length, std::string_view force);

/// A node of the model, with its numbers of coordinates and of degrees of freedom.
struct ModelNode {
  int number = 0;
  int dimensions = 0;
  int dofs = 0;
};

/// What a script of OpenSees builds, in SI: the free degrees of freedom alone, without those that follow others by
/// constraints. Rotations are in rad, and their rows in N m, kg m2.
struct ImportedModel {
  std::vector<ModelNode> nodes;
  std::string dofs_csv;  // as DofTable::read() takes it
  DofTable dofs;
  LinearStructure structure;           // the tangent stiffness that the script leaves, also as the initial one
  Eigen::VectorXd opensees_rad_per_s;  // lowest frequencies that OpenSees finds; none where it finds none
};

/// Runs a script in OpenSees, in the script's folder, and reads the model that it leaves. Waits until it ends.
/// @param program   as find_opensees() takes it.
/// @throws ConfigError where there is no OpenSees, the script fails, or its model is not one that can be read: too
///         large, degrees of freedom that are no displacements and rotations, matrices that are not symmetric.
[[nodiscard]] ImportedModel import_opensees(const std::filesystem::path& script, const std::string& program,
                                            const ModelUnits& units);

/// Row of an interface degree of freedom, written `node,dof` or `node.direction`.
/// @throws ConfigError saying why the model has none: no such node, fixed, follows another one, no mass.
[[nodiscard]] int interface_row(const ImportedModel& model, const std::string& address);

/// Frequencies that this program finds, of the lowest modes.
/// @throws ConfigError as vibration_modes() and without_massless().
[[nodiscard]] Eigen::VectorXd imported_frequencies_rad_per_s(const ImportedModel& model);

/// Writes stiffness.mtx, mass.mtx, dofs.csv and, where the damping is neither zero nor a sum of both, damping.mtx.
/// @param folder   exists.
/// @return the section `structure` that reads them.
/// @throws ConfigError when a file cannot be written.
[[nodiscard]] std::string write_structure(const ImportedModel& model, const std::filesystem::path& folder);

}  // namespace hybridtest
