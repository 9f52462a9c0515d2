#include "scenario/opensees_import/opensees_import.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "core/child_process.hpp"
#include "core/config_error.hpp"
#include "core/input_file.hpp"
#include "core/opensees_program.hpp"
#include "core/text/scalar.hpp"
#include "mechanics/structure/matrix_market.hpp"
#include "mechanics/structure/reduction.hpp"
#include "mechanics/structure/vibration_modes.hpp"
#include "scenario/opensees_import/import_text.hpp"
#include "scenario/opensees_import/tuning.hpp"

namespace hybridtest {
namespace {

namespace fs = std::filesystem;
using SparseMatrix = Eigen::SparseMatrix<double>;

struct Unit {
  const char* name;
  double si;
};
constexpr std::array kLengths{Unit{"m", 1.0}, Unit{"mm", 1e-3}, Unit{"cm", 1e-2}, Unit{"in", 0.0254},
                              Unit{"ft", 0.3048}};
constexpr std::array kForces{Unit{"N", 1.0},
                             Unit{"kN", 1e3},
                             Unit{"MN", 1e6},
                             Unit{"lbf", 4.4482216152605},
                             Unit{"kip", 4448.2216152605},
                             Unit{"kgf", 9.80665},
                             Unit{"tf", 9806.65}};

template <class Units>
std::vector<std::string> names_of(const Units& units) {
  std::vector<std::string> names;
  for (const Unit& unit : units) names.emplace_back(unit.name);
  return names;
}

template <class Units>
double si_of(const Units& units, std::string_view name) {
  const auto found = std::ranges::find_if(units, [&](const Unit& unit) { return unit.name == name; });
  if (found == units.end()) throw ConfigError{"no unit '" + std::string{name} + "'"};
  return found->si;
}

/// A folder for the files of one import, removed at the end.
class ImportFolder {
 public:
  ImportFolder() {
    std::string pattern = (fs::temp_directory_path() / "hybridtest_import_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error{pattern + ": cannot make a temporary folder"};
    path_ = pattern;
  }
  ImportFolder(const ImportFolder&) = delete;
  ImportFolder& operator=(const ImportFolder&) = delete;
  ~ImportFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  [[nodiscard]] fs::path operator/(const char* name) const { return path_ / name; }
  [[nodiscard]] const fs::path& path() const noexcept { return path_; }

 private:
  fs::path path_;
};

std::string file_text(const fs::path& file) {
  std::ifstream stream{file, std::ios::binary};
  return {std::istreambuf_iterator<char>{stream}, {}};
}

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream stream{file, std::ios::binary};
  stream << text;
  if (!stream.flush()) throw ConfigError{file.string() + ": cannot be written; choose another folder or make space"};
}

/// Leaves the files of import.tcl in the folder.
void run_import(const fs::path& script, const std::string& program, const ImportFolder& folder) {
  write_text(folder / "import.tcl", std::string{opensees_import_script()});
  ChildProcess opensees{
      "OpenSees",
      {.program = find_opensees(program),
       .arguments = {(folder / "import.tcl").string(), fs::absolute(script).string(), folder.path().string(),
                     std::to_string(kImportedDofsMax), std::to_string(kImportedModes)},
       .log_file = folder / "opensees.log",
       .is_killed_with_parent = true}};
  while (!opensees.wait_for_end(from_seconds(1.0))) {
  }
  const std::string error = file_text(folder / "error.txt");
  if (error.empty() && fs::exists(folder / "eigenvalues.txt")) return;
  std::string message = script.string() + ": OpenSees does not give its model";
  if (!error.empty()) message += ": " + error.substr(0, error.find_last_not_of('\n') + 1);
  if (opensees.signal() != 0) message += fmt::format(": signal {} ended it", opensees.signal());
  message += "\nthe last lines that OpenSees wrote:";
  for (const std::string& line : opensees.last_lines(kImportLines)) message += "\n  " + line;
  throw ConfigError{message};
}

std::vector<ModelNode> read_nodes(const fs::path& file) {
  std::istringstream text{file_text(file)};
  std::vector<ModelNode> nodes;
  for (ModelNode node; text >> node.number >> node.dimensions >> node.dofs;) nodes.push_back(node);
  return nodes;
}

const ModelNode* find_node(const std::vector<ModelNode>& nodes, int number) {
  const auto found = std::ranges::find(nodes, number, &ModelNode::number);
  return found == nodes.end() ? nullptr : &*found;
}

/// Position in kDirections of a degree of freedom, from 1, of a node.
/// @throws ConfigError for a node whose degrees of freedom are not displacements and then rotations.
std::size_t direction_of(const ModelNode& node, int dof) {
  const int displacements = node.dimensions;
  const int rotations = displacements == 3 ? 3 : displacements - 1;
  if (dof >= 1 && dof <= displacements) return static_cast<std::size_t>(dof - 1);
  if (node.dofs == displacements + rotations && dof <= node.dofs) {
    return displacements == 2 ? 5 : static_cast<std::size_t>(dof - 1);
  }
  throw ConfigError{fmt::format(
      "node {} has {} degrees of freedom in {} dimensions; expected displacements ({}), or displacements and "
      "rotations ({})",
      node.number, node.dofs, node.dimensions, displacements, displacements + rotations)};
}

/// The degrees of freedom of the rows, as a table; `lengths` gets the length unit of displacements and 1 of rotations.
std::string read_equations(const fs::path& file, const std::vector<ModelNode>& nodes, double length_m,
                           std::vector<double>& lengths) {
  std::istringstream text{file_text(file)};
  std::string table = "node,direction,name\n";
  int equation = 0;
  int number = 0;
  int dof = 0;
  while (text >> equation >> number >> dof) {
    const ModelNode* node = find_node(nodes, number);
    if (node == nullptr) throw ConfigError{fmt::format("an equation belongs to the unknown node {}", number)};
    const std::size_t direction = direction_of(*node, dof);
    const bool is_displacement = direction < 3;
    lengths.push_back(is_displacement ? length_m : 1.0);
    table += fmt::format("{0},{1},node_{0}_{2}{1}\n", number, kDirections.at(direction), is_displacement ? "u" : "");
  }
  return table;
}

/// Of energies force times length in the units of the script to SI, and its rows to metres and radians.
SparseMatrix read_scaled(const fs::path& file, const std::string& name, const Eigen::VectorXd& lengths,
                         double energy_j) {
  const SparseMatrix raw = read_matrix_market(file);
  const Eigen::VectorXd per_length = lengths.cwiseInverse();
  const SparseMatrix matrix = per_length.asDiagonal() * raw * per_length.asDiagonal();
  const SparseMatrix mirrored = matrix.transpose();
  const SparseMatrix difference = matrix - mirrored;
  double largest = 0.0;
  double worst = 0.0;
  for (Eigen::Index i = 0; i < matrix.nonZeros(); ++i) largest = std::max(largest, std::abs(matrix.valuePtr()[i]));
  for (Eigen::Index i = 0; i < difference.nonZeros(); ++i) {
    worst = std::max(worst, std::abs(difference.valuePtr()[i]));
  }
  if (worst > kAsymmetryMax * largest) {
    throw ConfigError{fmt::format(
        "the {} matrix is not symmetric: entries differ from their mirror image by up to {:.3g} of the largest one; "
        "expected a model without friction, follower forces or flow rules that are not associated: leave these parts "
        "out and let a substructure have them",
        name, worst / largest)};
  }
  SparseMatrix symmetric = 0.5 * energy_j * (matrix + mirrored);
  symmetric.prune(0.0, 0.0);
  return symmetric;
}

std::string matrix_text(const SparseMatrix& matrix) {
  std::string entries;
  Eigen::Index count = 0;
  for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry{matrix, column}; entry; ++entry) {
      if (entry.row() < column) continue;
      entries += fmt::format("{} {} {}\n", entry.row() + 1, column + 1, entry.value());
      ++count;
    }
  }
  return fmt::format("%%MatrixMarket matrix coordinate real symmetric\n{0} {0} {1}\n", matrix.rows(), count) + entries;
}

double dot(const SparseMatrix& a, const SparseMatrix& b) { return a.cwiseProduct(b).sum(); }

/// The section `damping` of C = a M + b K, of none, or of a file.
std::string damping_section(const LinearStructure& structure) {
  const SparseMatrix& c = structure.damping_n_s_per_m;
  const double size = c.norm();
  if (size == 0.0) return "{type: none}";
  const double mass_size = structure.mass_kg.norm();
  const double stiffness_size = structure.stiffness_n_per_m.norm();
  if (mass_size == 0.0 || stiffness_size == 0.0) return "damping.mtx";
  const SparseMatrix m = structure.mass_kg / mass_size;
  const SparseMatrix k = structure.stiffness_n_per_m / stiffness_size;
  const Eigen::Matrix2d products{{1.0, dot(m, k)}, {dot(m, k), 1.0}};
  Eigen::Vector2d factors = products.fullPivLu().solve(Eigen::Vector2d{dot(m, c), dot(k, c)});
  for (double& factor : factors) {
    if (std::abs(factor) <= kDampingRest * size) factor = 0.0;
  }
  const SparseMatrix rest = c - factors[0] * m - factors[1] * k;
  if (rest.norm() > kDampingRest * size || factors.minCoeff() < 0.0) return "damping.mtx";
  return fmt::format("{{type: mass_and_stiffness, mass_per_s: {}, stiffness_s: {}}}",
                     written_number(factors[0] / mass_size), written_number(factors[1] / stiffness_size));
}

/// Why a node and a direction of it are no row; empty where they are one.
std::string why_no_row(const ImportedModel& model, const std::string& node_text, const std::string& dof_text) {
  const Whole number = read_whole(node_text);
  const ModelNode* node = number.form == NumberForm::number && std::in_range<int>(number.value)
                              ? find_node(model.nodes, static_cast<int>(number.value))
                              : nullptr;
  if (node == nullptr) {
    std::string known;
    for (std::size_t i = 0; i < std::min(model.nodes.size(), kImportLines); ++i) {
      known += fmt::format("{}{}", i == 0 ? "" : ", ", model.nodes[i].number);
    }
    if (model.nodes.size() > kImportLines) known += ", …";
    return "the model has no node '" + node_text + "'; its nodes are " + known;
  }
  return fmt::format(
      "degree of freedom {} of node {}, which has {}, is fixed, follows another one by a constraint, or does not "
      "exist; "
      "name one that is free",
      dof_text, node->number, node->dofs);
}

}  // namespace

const std::vector<std::string>& length_unit_names() {
  static const std::vector<std::string> kNames = names_of(kLengths);
  return kNames;
}

const std::vector<std::string>& force_unit_names() {
  static const std::vector<std::string> kNames = names_of(kForces);
  return kNames;
}

ModelUnits model_units(std::string_view length, std::string_view force) {
  return {.length_m = si_of(kLengths, length), .force_n = si_of(kForces, force)};
}

ImportedModel import_opensees(const fs::path& script, const std::string& program, const ModelUnits& units) {
  if (const auto why = why_unreadable(script)) throw ConfigError{script.string() + ": " + *why};
  const ImportFolder folder;
  run_import(script, program, folder);
  ImportedModel model;
  model.nodes = read_nodes(folder / "nodes.txt");
  try {
    std::vector<double> lengths;
    model.dofs_csv = read_equations(folder / "equations.txt", model.nodes, units.length_m, lengths);
    model.dofs = DofTable::parse(model.dofs_csv, script.string());
    const Eigen::VectorXd scale =
        Eigen::Map<const Eigen::VectorXd>(lengths.data(), static_cast<Eigen::Index>(lengths.size()));
    const double energy_j = units.force_n * units.length_m;
    model.structure.degrees_of_freedom = model.dofs.names();
    model.structure.mass_kg = read_scaled(folder / "mass.mtx", "mass", scale, energy_j);
    model.structure.damping_n_s_per_m = read_scaled(folder / "damping.mtx", "damping", scale, energy_j);
    model.structure.stiffness_n_per_m = read_scaled(folder / "stiffness.mtx", "stiffness", scale, energy_j);
    model.structure.initial_stiffness_n_per_m = model.structure.stiffness_n_per_m;
    model.structure.influence = Eigen::VectorXd::Ones(scale.size());
  } catch (const ConfigError& error) {
    throw ConfigError{script.string() + ": " + error.what()};
  }
  std::istringstream eigenvalues{file_text(folder / "eigenvalues.txt")};
  std::vector<double> found;
  for (double value = 0.0; eigenvalues >> value;) found.push_back(std::sqrt(std::max(0.0, value)));
  model.opensees_rad_per_s = Eigen::Map<const Eigen::VectorXd>(found.data(), static_cast<Eigen::Index>(found.size()));
  return model;
}

int interface_row(const ImportedModel& model, const std::string& address) {
  const std::size_t separator = address.find_first_of(",.");
  if (separator == std::string::npos) {
    throw ConfigError{"--interface " + address + ": expected a node and its degree of freedom, such as 3,1"};
  }
  const std::string node = address.substr(0, separator);
  std::string dof = address.substr(separator + 1);
  // The third degree of freedom of a plane node is its rotation.
  const Whole number = read_whole(node);
  if (dof == "3" && number.form == NumberForm::number && std::in_range<int>(number.value)) {
    const ModelNode* found = find_node(model.nodes, static_cast<int>(number.value));
    if (found != nullptr && found->dimensions == 2) dof = "rz";
  }
  const std::optional<int> row = model.dofs.find(node + "." + dof);
  if (!row) throw ConfigError{"--interface " + address + ": " + why_no_row(model, node, dof)};
  if (model.structure.mass_kg.coeff(*row, *row) == 0.0) {
    throw ConfigError{"--interface " + address +
                      ": has no mass and is condensed; give it a mass in the script, or name one that has"};
  }
  return *row;
}

Eigen::VectorXd imported_frequencies_rad_per_s(const ImportedModel& model) {
  LinearStructure structure = model.structure;
  structure.damping_n_s_per_m = SparseMatrix(structure.size(), structure.size());
  structure = without_massless(structure).structure;
  structure.initial_stiffness_n_per_m = structure.stiffness_n_per_m;
  const Eigen::Index count = std::min(kImportedModes, structure.size());
  return vibration_modes(structure, count).frequency_rad_per_s.head(count);
}

std::string write_structure(const ImportedModel& model, const fs::path& folder) {
  write_text(folder / "mass.mtx", matrix_text(model.structure.mass_kg));
  write_text(folder / "stiffness.mtx", matrix_text(model.structure.stiffness_n_per_m));
  write_text(folder / "dofs.csv", model.dofs_csv);
  const std::string damping = damping_section(model.structure);
  if (damping == "damping.mtx") write_text(folder / damping, matrix_text(model.structure.damping_n_s_per_m));
  return "structure:\n  mass: mass.mtx\n  stiffness: stiffness.mtx\n  degrees_of_freedom: dofs.csv\n  damping: " +
         damping + "\n";
}

}  // namespace hybridtest
