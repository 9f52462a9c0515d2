#include "mechanics/structure/reduction.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

constexpr Eigen::Index kColumnsAtOnce = 64;
constexpr Eigen::Index kGone = -1;

/// New row of each old one, kGone for those that are not kept.
std::vector<Eigen::Index> new_rows(Eigen::Index size, const std::vector<Eigen::Index>& kept) {
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(size), kGone);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    rows[static_cast<std::size_t>(kept[i])] = static_cast<Eigen::Index>(i);
  }
  return rows;
}

/// The rows and columns of these lists alone.
SparseMatrix part_of(const SparseMatrix& matrix, const std::vector<Eigen::Index>& rows,
                     const std::vector<Eigen::Index>& columns) {
  const std::vector<Eigen::Index> new_row = new_rows(matrix.rows(), rows);
  Triplets entries;
  for (std::size_t column = 0; column < columns.size(); ++column) {
    for (SparseMatrix::InnerIterator entry{matrix, columns[column]}; entry; ++entry) {
      const Eigen::Index row = new_row[static_cast<std::size_t>(entry.row())];
      if (row != kGone) entries.emplace_back(static_cast<int>(row), static_cast<int>(column), entry.value());
    }
  }
  SparseMatrix part(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(columns.size()));
  part.setFromTriplets(entries.begin(), entries.end());
  return part;
}

/// Names and influence of the kept degrees of freedom.
ReducedStructure of_kept(const LinearStructure& given, std::vector<Eigen::Index> kept) {
  ReducedStructure reduced;
  for (const Eigen::Index row : kept) {
    const auto name = static_cast<std::size_t>(row);
    if (name < given.degrees_of_freedom.size()) {
      reduced.structure.degrees_of_freedom.push_back(given.degrees_of_freedom[name]);
    }
  }
  if (given.influence.size() > 0) reduced.structure.influence = given.influence(kept);
  reduced.kept = std::move(kept);
  return reduced;
}

bool has_entry(const SparseMatrix& matrix, Eigen::Index column) {
  if (matrix.size() == 0) return false;
  for (SparseMatrix::InnerIterator entry{matrix, column}; entry; ++entry) {
    if (entry.value() != 0.0) return true;
  }
  return false;
}

void require_condensable(const LinearStructure& given, Eigen::Index dof) {
  const std::string name = "degree of freedom " + dof_name(given, dof) + " has no mass, ";
  if (has_entry(given.mass_kg, dof)) {
    throw ConfigError{name + "but its row of the mass matrix is not zero; expected all of it zero, or a mass"};
  }
  if (has_entry(given.damping_n_s_per_m, dof)) {
    throw ConfigError{name +
                      "but damping of its own, and cannot be condensed; give it a mass, or take its row out of the "
                      "damping matrix"};
  }
}

/// K_ss^-1, checked.
class MasslessPart {
 public:
  MasslessPart(const LinearStructure& given, const std::vector<Eigen::Index>& massless)
      : factor_{part_of(given.stiffness_n_per_m, massless, massless)} {
    constexpr double kPivotRounding = 1e-12;
    const Eigen::VectorXd& pivots = factor_.vectorD();
    Eigen::Index weakest = 0;
    const double smallest = pivots.minCoeff(&weakest);
    if (factor_.info() == Eigen::Success && smallest > kPivotRounding * pivots.maxCoeff()) return;
    const auto& order = factor_.permutationP().indices();
    const auto* const at = std::find(order.data(), order.data() + order.size(), static_cast<int>(weakest));
    throw ConfigError{"degree of freedom " + dof_name(given, massless[static_cast<std::size_t>(at - order.data())]) +
                      " has no mass, and nothing holds it while the others with mass stand still; give it a mass, or "
                      "take it out of the matrices"};
  }

  [[nodiscard]] Eigen::MatrixXd solution(const Eigen::MatrixXd& right_hand_side) const {
    return factor_.solve(right_hand_side);
  }

 private:
  Eigen::SimplicialLDLT<SparseMatrix> factor_;
};

/// K_rs K_ss^-1 K_sr, symmetric.
SparseMatrix condensed_stiffness(const LinearStructure& given, const std::vector<Eigen::Index>& massless,
                                 const SparseMatrix& coupling) {
  const MasslessPart inner{given, massless};
  // Only what the massless ones touch.
  std::vector<Eigen::Index> touched;
  for (Eigen::Index column = 0; column < coupling.cols(); ++column) {
    if (has_entry(coupling, column)) touched.push_back(column);
  }
  const auto count = static_cast<Eigen::Index>(touched.size());
  Triplets entries;
  for (Eigen::Index begin = 0; begin < count; begin += kColumnsAtOnce) {
    const Eigen::Index columns = std::min(kColumnsAtOnce, count - begin);
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(coupling.rows(), columns);
    for (Eigen::Index i = 0; i < columns; ++i) {
      right.col(i) = coupling.col(touched[static_cast<std::size_t>(begin + i)]);
    }
    const Eigen::MatrixXd block = coupling.transpose() * inner.solution(right);
    const double rounding = std::numeric_limits<double>::epsilon() * block.cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < columns; ++i) {
      const auto column = static_cast<int>(touched[static_cast<std::size_t>(begin + i)]);
      for (const Eigen::Index row : touched) {
        if (std::abs(block(row, i)) > rounding) entries.emplace_back(static_cast<int>(row), column, block(row, i));
      }
    }
    if (std::cmp_greater(entries.size(), kCondensedEntriesMax)) {
      throw ConfigError{"without its " + std::to_string(massless.size()) +
                        " degrees of freedom that have no mass, the stiffness matrix would have more than " +
                        std::to_string(kCondensedEntriesMax) + " entries; give some of them a mass, for example " +
                        dof_name(given, massless.front())};
    }
  }
  SparseMatrix product(coupling.cols(), coupling.cols());
  product.setFromTriplets(entries.begin(), entries.end());
  return 0.5 * (product + SparseMatrix{product.transpose()});
}

}  // namespace

ReducedStructure with_constraints(const LinearStructure& given, const std::vector<RigidConstraint>& constraints) {
  std::vector<const RigidConstraint*> of_dof(static_cast<std::size_t>(given.size()), nullptr);
  for (const RigidConstraint& constraint : constraints) {
    const RigidConstraint*& entry = of_dof[static_cast<std::size_t>(constraint.dof)];
    if (entry != nullptr) {
      throw ConfigError{"degree of freedom " + dof_name(given, constraint.dof) + " has two constraints, expected one"};
    }
    entry = &constraint;
  }
  std::vector<Eigen::Index> kept;
  for (Eigen::Index dof = 0; dof < given.size(); ++dof) {
    if (of_dof[static_cast<std::size_t>(dof)] == nullptr) kept.push_back(dof);
  }
  const std::vector<Eigen::Index> new_row = new_rows(given.size(), kept);
  Triplets entries;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    entries.emplace_back(static_cast<int>(kept[i]), static_cast<int>(i), 1.0);
  }
  for (const RigidConstraint& constraint : constraints) {
    for (const auto& [other, factor] : constraint.follows) {
      const Eigen::Index column = new_row[static_cast<std::size_t>(other)];
      if (column == kGone) {
        throw ConfigError{"degree of freedom " + dof_name(given, constraint.dof) + " follows " +
                          dof_name(given, other) + ", which has a constraint itself; expected one without"};
      }
      entries.emplace_back(static_cast<int>(constraint.dof), static_cast<int>(column), factor);
    }
  }
  SparseMatrix to_all(given.size(), static_cast<Eigen::Index>(kept.size()));
  to_all.setFromTriplets(entries.begin(), entries.end());
  const SparseMatrix to_kept = to_all.transpose();
  const auto reduced_matrix = [&](const SparseMatrix& matrix) -> SparseMatrix {
    return matrix.size() == 0 ? SparseMatrix{} : SparseMatrix{to_kept * matrix * to_all};
  };
  ReducedStructure reduced = of_kept(given, std::move(kept));
  reduced.structure.mass_kg = reduced_matrix(given.mass_kg);
  reduced.structure.damping_n_s_per_m = reduced_matrix(given.damping_n_s_per_m);
  reduced.structure.stiffness_n_per_m = reduced_matrix(given.stiffness_n_per_m);
  return reduced;
}

ReducedStructure without_massless(const LinearStructure& given) {
  std::vector<Eigen::Index> kept;
  std::vector<Eigen::Index> massless;
  for (Eigen::Index dof = 0; dof < given.size(); ++dof) {
    (given.mass_kg.coeff(dof, dof) == 0.0 ? massless : kept).push_back(dof);
  }
  ReducedStructure reduced = of_kept(given, kept);
  if (massless.empty()) {
    reduced.structure = given;
    return reduced;
  }
  require_symmetric(given);
  for (const Eigen::Index dof : massless) require_condensable(given, dof);
  reduced.structure.mass_kg = part_of(given.mass_kg, kept, kept);
  if (given.damping_n_s_per_m.size() > 0) {
    reduced.structure.damping_n_s_per_m = part_of(given.damping_n_s_per_m, kept, kept);
  }
  const SparseMatrix coupling = part_of(given.stiffness_n_per_m, massless, kept);
  reduced.structure.stiffness_n_per_m =
      part_of(given.stiffness_n_per_m, kept, kept) - condensed_stiffness(given, massless, coupling);
  return reduced;
}

}  // namespace hybridtest
