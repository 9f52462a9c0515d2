#include "mechanics/structure/linear_structure.hpp"

#include <Eigen/SparseCholesky>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/config_error.hpp"
#include "mechanics/structure/stiffness_matrix.hpp"

namespace hybridtest {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

class Findings {
 public:
  void add(std::string what) {
    issues_.push_back(ConfigIssue{.file = {}, .line = 0, .column = 0, .what = std::move(what)});
  }
  [[nodiscard]] bool any() const noexcept { return !issues_.empty(); }
  void throw_if_any() {
    if (any()) throw ConfigError{std::move(issues_)};
  }

 private:
  std::vector<ConfigIssue> issues_;
};

void check_size(const SparseMatrix& matrix, const std::string& name, Eigen::Index size, Findings& findings) {
  if (matrix.rows() == size && matrix.cols() == size) return;
  findings.add("the " + name + " matrix is " + std::to_string(matrix.rows()) + " by " + std::to_string(matrix.cols()) +
               ", expected " + std::to_string(size) + " by " + std::to_string(size) +
               ", one row and column per degree of freedom");
}

void check_finite(const LinearStructure& structure, const SparseMatrix& matrix, const std::string& name,
                  Findings& findings) {
  for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry{matrix, column}; entry; ++entry) {
      if (std::isfinite(entry.value())) continue;
      findings.add("the " + name + " matrix holds a number that is not finite, at " + dof_name(structure, entry.row()) +
                   " and " + dof_name(structure, entry.col()));
      return;
    }
  }
}

void check_symmetric(const LinearStructure& structure, const SparseMatrix& matrix, const std::string& name,
                     Findings& findings) {
  const SparseMatrix transposed = matrix.transpose();
  // The transposed one is compressed, which the matrix itself need not be.
  const double largest = transposed.nonZeros() == 0 ? 0.0 : transposed.coeffs().abs().maxCoeff();
  const SparseMatrix difference = matrix - transposed;
  for (Eigen::Index column = 0; column < difference.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry{difference, column}; entry; ++entry) {
      if (std::abs(entry.value()) <= kSymmetryTolerance * largest) continue;
      findings.add("the " + name + " matrix is not symmetric: its entries at " + dof_name(structure, entry.row()) +
                   " and " + dof_name(structure, entry.col()) + " differ by " + std::to_string(entry.value()));
      return;
    }
  }
}

void check_mass(const LinearStructure& structure, Findings& findings) {
  bool is_massless_somewhere = false;
  for (Eigen::Index dof = 0; dof < structure.size(); ++dof) {
    if (structure.mass_kg.coeff(dof, dof) > 0.0) continue;
    is_massless_somewhere = true;
    findings.add("degree of freedom " + dof_name(structure, dof) +
                 " has no mass; an explicit integrator needs a positive mass on every degree of freedom: give it one "
                 "or condense it out of the structure");
  }
  if (is_massless_somewhere) return;
  const Eigen::SimplicialLDLT<SparseMatrix> factor{structure.mass_kg};
  if (factor.info() == Eigen::Success && factor.vectorD().minCoeff() > 0.0) return;
  findings.add("the mass matrix is not positive definite: some motion of the structure has no inertia");
}

}  // namespace

Eigen::VectorXd LinearStructure::load_per_ground_acceleration_kg() const { return -(mass_kg * influence); }

std::string dof_name(const LinearStructure& structure, Eigen::Index dof) {
  const auto index = static_cast<std::size_t>(dof);
  if (index < structure.degrees_of_freedom.size()) return "'" + structure.degrees_of_freedom[index] + "'";
  return "number " + std::to_string(dof + 1);
}

void require_symmetric(const LinearStructure& structure) {
  Findings findings;
  check_symmetric(structure, structure.mass_kg, "mass", findings);
  check_symmetric(structure, structure.stiffness_n_per_m, "stiffness", findings);
  findings.throw_if_any();
}

void require_consistent(const LinearStructure& structure) {
  Findings findings;
  const Eigen::Index size = structure.size();
  if (size == 0) throw ConfigError{"the structure has no degree of freedom, expected at least one"};
  if (!structure.degrees_of_freedom.empty() && std::cmp_not_equal(structure.degrees_of_freedom.size(), size)) {
    findings.add("the structure has " + std::to_string(structure.degrees_of_freedom.size()) +
                 " names of degrees of freedom, expected " + std::to_string(size) + ", as many as the mass has rows");
  }
  check_size(structure.mass_kg, "mass", size, findings);
  check_size(structure.damping_n_s_per_m, "damping", size, findings);
  if (structure.stiffness_n_per_m.size() > 0) check_size(structure.stiffness_n_per_m, "stiffness", size, findings);
  check_size(structure.initial_stiffness_n_per_m, "initial stiffness", size, findings);
  if (structure.influence.size() != size) {
    findings.add("the influence vector has " + std::to_string(structure.influence.size()) + " entries, expected " +
                 std::to_string(size));
  }
  findings.throw_if_any();
  check_finite(structure, structure.mass_kg, "mass", findings);
  check_finite(structure, structure.damping_n_s_per_m, "damping", findings);
  check_finite(structure, structure.stiffness_n_per_m, "stiffness", findings);
  check_finite(structure, structure.initial_stiffness_n_per_m, "initial stiffness", findings);
  if (!structure.influence.allFinite()) findings.add("the influence vector holds a number that is not finite");
  findings.throw_if_any();
  check_symmetric(structure, structure.mass_kg, "mass", findings);
  check_symmetric(structure, structure.stiffness_n_per_m, "stiffness", findings);
  if (!findings.any()) {
    check_symmetric(structure, structure.initial_stiffness_n_per_m, "initial stiffness", findings);
  }
  check_mass(structure, findings);
  findings.throw_if_any();
}

}  // namespace hybridtest
