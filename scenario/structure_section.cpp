#include "scenario/structure_section.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <utility>

#include "core/config_error.hpp"
#include "core/text/nearest_name.hpp"
#include "mechanics/structure/damping.hpp"
#include "mechanics/structure/matrix_market.hpp"
#include "mechanics/structure/reduction.hpp"
#include "mechanics/structure/vibration_modes.hpp"
#include "scenario/named_file.hpp"

namespace hybridtest {
namespace {

using config::Section;
using SparseMatrix = Eigen::SparseMatrix<double>;
using DampingRule = std::function<SparseMatrix(const LinearStructure&)>;

constexpr std::size_t kEvenlyRecorded = 20;

SparseMatrix sparse_diagonal(const Eigen::VectorXd& values) {
  SparseMatrix matrix(values.size(), values.size());
  matrix.setIdentity();
  matrix.diagonal() = values;
  return matrix;
}

/// Of one section: reads the files that it names.
class StructureFiles {
 public:
  StructureFiles(Section& section, const std::filesystem::path& directory, std::vector<NamedFile>& files)
      : section_{section}, directory_{directory}, files_{files} {}

  /// Whatever `read` makes of the file at the key; what it throws is reported there.
  template <class Read>
  auto from_file(std::string_view key, Read read) -> std::optional<decltype(read(std::filesystem::path{}))> {
    const std::string written = section_.text(key);
    const std::optional<std::filesystem::path> file = named_file(section_, key, directory_);
    if (!file) return std::nullopt;
    files_.push_back({.file = *file, .written = written});
    try {
      return read(*file);
    } catch (const ConfigError& error) {
      section_.error(key, error.what());
      return std::nullopt;
    }
  }

  /// A square matrix with a row for each degree of freedom; of another one, zero.
  SparseMatrix matrix(std::string_view key, std::size_t dofs) {
    const auto size = static_cast<Eigen::Index>(dofs);
    const std::optional<SparseMatrix> found = from_file(key, read_matrix_market);
    if (!found) return SparseMatrix(size, size);
    if (found->rows() == size && found->cols() == size) return *found;
    section_.error(key, "the matrix is " + std::to_string(found->rows()) + " by " + std::to_string(found->cols()) +
                            "; expected " + std::to_string(size) + " by " + std::to_string(size) +
                            ", a row and a column for each degree of freedom of degrees_of_freedom");
    return SparseMatrix(size, size);
  }

 private:
  Section& section_;
  const std::filesystem::path& directory_;
  std::vector<NamedFile>& files_;
};

/// Masses of named degrees of freedom: one for each, or a full matrix.
SparseMatrix read_named_mass(Section& section, const std::vector<std::string>& names) {
  if (section.has("mass_matrix_kg")) {
    return section.matrix("mass_matrix_kg", names.size(), names.size()).sparseView();
  }
  return sparse_diagonal(section.numbers_by_name("mass_kg", names, kPositive));
}

DampingRule read_damping(Section section, std::size_t dofs) {
  constexpr Range kRatio{.low = 0.0, .high = 1.0, .high_open = true};
  const auto type = section.choice("type", {"none", "rayleigh", "mass_and_stiffness", "modal", "matrix"});
  DampingRule rule = [](const LinearStructure& structure) { return SparseMatrix{structure.size(), structure.size()}; };
  if (type == 1) {
    const double ratio = section.number("ratio", kRatio);
    const auto modes = section.integers("modes", 1, static_cast<std::int64_t>(dofs));
    if (modes.size() != 2) {
      section.error("modes", "expected two modes, such as [1, 2]");
    } else {
      rule = [ratio, modes](const LinearStructure& structure) {
        return rayleigh_damping(structure,
                                rayleigh_coefficients(ratio, static_cast<int>(modes[0]), static_cast<int>(modes[1]),
                                                      vibration_modes(structure, std::max(modes[0], modes[1]))));
      };
    }
  } else if (type == 2) {
    const RayleighCoefficients coefficients{section.number("mass_per_s", kNotNegative),
                                            section.number("stiffness_s", kNotNegative)};
    rule = [coefficients](const LinearStructure& structure) { return rayleigh_damping(structure, coefficients); };
  } else if (type == 3) {
    const Eigen::VectorXd ratios = section.numbers("ratios", 0, kRatio);
    rule = [ratios](const LinearStructure& structure) {
      return modal_damping(structure, vibration_modes(structure, ratios.size()), ratios);
    };
  } else if (type == 4) {
    const Eigen::MatrixXd matrix = section.matrix("matrix_n_s_per_m", dofs, dofs);
    rule = [matrix](const LinearStructure&) { return SparseMatrix{matrix.sparseView()}; };
  }
  section.finish();
  return rule;
}

/// HDF5 keeps the description of a table's columns in 64 KiB: of each its name, and some 24 bytes.
void check_recordable(Section& root, const DofTable& dofs, const std::vector<Eigen::Index>& recorded,
                      bool records_forces) {
  constexpr std::size_t kDescriptionMax_bytes = 64'000;
  constexpr std::size_t kBesideNames_bytes = 72 + 4 * 24;  // displacement_…_m and the other three columns
  constexpr std::size_t kBesideForceName_bytes = 16 + 24;  // applied_force_…_n
  if (dofs.size() == 0) return;                            // reported
  std::size_t description_bytes = 0;
  for (const Eigen::Index row : recorded) {
    const std::string& name = dofs.names()[static_cast<std::size_t>(row)];
    description_bytes += 4 * name.size() + kBesideNames_bytes;
    if (records_forces) description_bytes += name.size() + kBesideForceName_bytes;
    if (name.size() <= kDofNameLongest) continue;
    root.error("structure", "the degree of freedom '" + name + "' has a name of " + std::to_string(name.size()) +
                                " letters; expected at most " + std::to_string(kDofNameLongest) + " in a recording");
  }
  if (description_bytes <= kDescriptionMax_bytes) return;
  const std::size_t fit = recorded.size() * kDescriptionMax_bytes / description_bytes;
  root.error("output", std::to_string(recorded.size()) +
                           " degrees of freedom to record, those at interfaces among them; with names as long as these "
                           "a table of a recording holds " +
                           std::to_string(fit) + ": list fewer");
}

/// The list `constraints`, one for each degree of freedom that others carry along.
std::vector<RigidConstraint> read_constraints(Section& section, const DofTable& dofs) {
  std::vector<RigidConstraint> constraints;
  for (Section& entry : section.sections("constraints")) {
    RigidConstraint constraint{.dof = dof_position(entry, "dof", dofs), .follows = {}};
    Section others = entry.section("equals");
    for (const std::string& key : others.keys()) {
      const double factor = others.number(key);
      if (const std::optional<int> row = dofs.find(key)) {
        constraint.follows.emplace_back(*row, factor);
      } else {
        others.error(key, no_such_dof(key, dofs));
      }
    }
    others.finish();
    entry.finish();
    constraints.push_back(std::move(constraint));
  }
  return constraints;
}

/// Without degrees of freedom that have a constraint, then without those that have no mass.
void reduce(const std::vector<RigidConstraint>& constraints, StructureReading& reading) {
  if (reading.dofs.size() == 0 || reading.structure.mass_kg.rows() == 0) return;  // reported
  const auto take = [&](ReducedStructure reduced, const std::string& why_gone) {
    if (reduced.kept.size() == reading.dofs.size()) return;
    reading.dofs = reading.dofs.only(reduced.kept, why_gone);
    reading.structure = std::move(reduced.structure);
  };
  if (!constraints.empty()) {
    take(with_constraints(reading.structure, constraints), "follows others by a constraint; name one that it follows");
  }
  take(without_massless(reading.structure), "has no mass and is condensed; give it a mass to use it");
}

}  // namespace

StructureReading read_structure(Section section, const std::filesystem::path& directory) {
  StructureReading reading;
  StructureFiles files{section, directory, reading.files};
  LinearStructure& structure = reading.structure;
  std::vector<RigidConstraint> constraints;
  const bool has_matrices = section.has_optional("mass");
  if (has_matrices) {
    reading.dofs = files.from_file("degrees_of_freedom", DofTable::read).value_or(DofTable{});
    structure.mass_kg = files.matrix("mass", reading.dofs.size());
    structure.stiffness_n_per_m = files.matrix("stiffness", reading.dofs.size());
    structure.degrees_of_freedom = reading.dofs.names();
    if (section.has_optional("constraints")) constraints = read_constraints(section, reading.dofs);
  } else {
    reading.dofs = DofTable{section.names("degrees_of_freedom")};
    structure.mass_kg = read_named_mass(section, reading.dofs.names());
    if (section.has_optional("stiffness")) {
      structure.stiffness_n_per_m = files.matrix("stiffness", reading.dofs.size());
    }
  }
  structure.degrees_of_freedom = reading.dofs.names();
  const bool is_damping_a_file = section.has("damping") && !section.has_mapping("damping");
  if (is_damping_a_file) {
    structure.damping_n_s_per_m = files.matrix("damping", reading.dofs.size());
  } else {
    reading.damping = read_damping(section.section("damping"), reading.dofs.size());
  }
  section.finish();
  try {
    if (has_matrices) reduce(constraints, reading);
  } catch (const ConfigError& error) {
    section.error("mass", error.what());
  }
  if (is_damping_a_file) {
    reading.damping = [matrix = structure.damping_n_s_per_m](const LinearStructure&) { return matrix; };
  }
  return reading;
}

std::string no_such_dof(const std::string& address, const DofTable& dofs) {
  if (const std::string why = dofs.why_gone(address); !why.empty()) {
    return "the degree of freedom '" + address + "' " + why;
  }
  std::string what = "no degree of freedom '" + address + "'";
  if (const auto nearest = nearest_name(address, dofs.names())) return what + "; did you mean '" + *nearest + "'?";
  if (!dofs.has_directions()) return what;
  return what + "; expected its name, node.direction such as '" + dofs.names().front() + "', or such as 'node 1 dof 1'";
}

Eigen::VectorXd values_by_dof(Section mapping, const DofTable& dofs) {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(dofs.size()));
  for (const std::string& key : mapping.keys()) {
    const double value = mapping.number(key);
    if (const std::optional<int> row = dofs.find(key)) {
      values[*row] = value;
    } else {
      mapping.error(key, no_such_dof(key, dofs));
    }
  }
  mapping.finish();
  return values;
}

Eigen::VectorXd uniform_influence(const DofTable& dofs, std::size_t direction) {
  const auto size = static_cast<Eigen::Index>(dofs.size());
  if (!dofs.has_directions()) return Eigen::VectorXd::Ones(size);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(size);
  for (const int row : dofs.in_direction(direction)) values[row] = 1.0;
  return values;
}

Eigen::VectorXd read_influence(Section& excitation, const DofTable& dofs) {
  if (const auto mapping = excitation.optional_section("influence")) return values_by_dof(*mapping, dofs);
  if (!dofs.has_directions()) return uniform_influence(dofs, 0);
  const std::size_t direction = excitation.choice("direction", {kDirections.begin(), kDirections.end()}, "x");
  if (dofs.in_direction(direction).empty()) {
    excitation.error("direction", "no degree of freedom has the direction " + std::string{kDirections.at(direction)} +
                                      ": the ground motion would move nothing");
  }
  return uniform_influence(dofs, direction);
}

std::vector<Eigen::Index> read_output(Section& root, const DofTable& dofs, const InterfaceRows& interfaces,
                                      bool records_forces) {
  std::set<Eigen::Index> rows;
  if (interfaces.are_recorded) rows.insert(interfaces.rows.begin(), interfaces.rows.end());
  if (auto output = root.optional_section("output")) {
    for (const std::string& pattern : output->names("degrees_of_freedom")) {
      if (pattern == "interfaces") {
        rows.insert(interfaces.rows.begin(), interfaces.rows.end());
        continue;
      }
      const std::vector<int> found = dofs.matching(pattern == "all" ? "*" : pattern);
      if (found.empty()) output->error("degrees_of_freedom", no_such_dof(pattern, dofs));
      rows.insert(found.begin(), found.end());
    }
    output->finish();
  } else if (dofs.size() <= kAllRecordedUpTo) {
    for (std::size_t row = 0; row < dofs.size(); ++row) rows.insert(static_cast<Eigen::Index>(row));
  } else {
    for (std::size_t i = 0; i < kEvenlyRecorded; ++i) {
      rows.insert(static_cast<Eigen::Index>(i * (dofs.size() - 1) / (kEvenlyRecorded - 1)));
    }
  }
  std::vector<Eigen::Index> recorded{rows.begin(), rows.end()};
  check_recordable(root, dofs, recorded, records_forces);
  return recorded;
}

int dof_position(Section& section, std::string_view key, const DofTable& dofs) {
  const std::string address = section.text(key);
  if (const std::optional<int> row = dofs.find(address)) return *row;
  if (!address.empty()) section.error(key, no_such_dof(address, dofs));
  return 0;
}

}  // namespace hybridtest
