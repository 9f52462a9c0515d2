#pragma once

#include <Eigen/SparseCore>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/section.hpp"
#include "mechanics/structure/linear_structure.hpp"
#include "scenario/dof_table.hpp"
#include "scenario/named_file.hpp"

namespace hybridtest {

/// What the section `structure` says. `structure` has mass and stiffness; damping follows from the rule once the
/// initial stiffness of everything is known.
struct StructureReading {
  DofTable dofs;
  LinearStructure structure;
  std::function<Eigen::SparseMatrix<double>(const LinearStructure&)> damping;
  std::vector<NamedFile> files;
};

/// Reports what is wrong at its key.
/// @param directory   relative paths start there.
[[nodiscard]] StructureReading read_structure(config::Section section, const std::filesystem::path& directory);

/// How the ground moves the degrees of freedom, iota: those of `direction` by 1, or as the mapping `influence` says.
/// Without a table of degrees of freedom and without the mapping, all by 1.
[[nodiscard]] Eigen::VectorXd read_influence(config::Section& excitation, const DofTable& dofs);

/// 1 at the degrees of freedom of a direction, as its position in kDirections; without a table of them, 1 at all.
[[nodiscard]] Eigen::VectorXd uniform_influence(const DofTable& dofs, std::size_t direction);

/// A mapping from degrees of freedom to numbers; 0 for those left out. Reports what is no degree of freedom.
[[nodiscard]] Eigen::VectorXd values_by_dof(config::Section mapping, const DofTable& dofs);

/// The message for an address that no degree of freedom has.
[[nodiscard]] std::string no_such_dof(const std::string& address, const DofTable& dofs);

/// Without the section `output`, as many degrees of freedom of a structure or of an interface are all recorded.
inline constexpr std::size_t kAllRecordedUpTo = 100;

/// Degrees of freedom at interfaces.
struct InterfaceRows {
  std::vector<Eigen::Index> rows;
  bool are_recorded = true;  // in any case; otherwise where `output` lists `interfaces`
};

/// Rows of the degrees of freedom that the coordinator records, in order: those of `output`, or without that section
/// all of a structure of up to kAllRecordedUpTo, of a larger one 20 evenly over the table; and those of `interfaces`.
/// @param records_forces   a column more for each, the applied force.
/// Reports more of them than the columns of a table hold, and names that are too long for a column.
[[nodiscard]] std::vector<Eigen::Index> read_output(config::Section& root, const DofTable& dofs,
                                                    const InterfaceRows& interfaces, bool records_forces);

/// Row that the text at `key` addresses; reports an unknown one and returns 0.
[[nodiscard]] int dof_position(config::Section& section, std::string_view key, const DofTable& dofs);

}  // namespace hybridtest
