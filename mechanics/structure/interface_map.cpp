#include "mechanics/structure/interface_map.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "core/assert.hpp"
#include "core/config_error.hpp"

namespace hybridtest {

InterfaceMap::InterfaceMap(Eigen::Index structure_size, std::vector<InterfaceDof> dofs)
    : structure_size_{structure_size}, dofs_{std::move(dofs)} {
  if (std::cmp_greater(dofs_.size(), kMaxInterfaceDofs)) {
    throw ConfigError{"the interface has " + std::to_string(dofs_.size()) + " degrees of freedom, expected at most " +
                      std::to_string(kMaxInterfaceDofs)};
  }
  for (std::size_t k = 0; k < dofs_.size(); ++k) {
    const auto [dof, base] = dofs_[k];
    const bool base_exists = base == InterfaceDof::kGround || (base >= 0 && base < structure_size);
    if (dof >= 0 && dof < structure_size && base_exists && base != dof) continue;
    throw ConfigError{"interface degree of freedom " + std::to_string(k + 1) + " is " + std::to_string(dof) +
                      " relative to " + std::to_string(base) + ", expected two different ones of 0 to " +
                      std::to_string(structure_size - 1) + ", or the ground (-1) as the second"};
  }
}

bool InterfaceMap::uses(Eigen::Index structure_dof) const noexcept {
  return std::ranges::any_of(dofs_, [structure_dof](const InterfaceDof& interface) {
    return interface.dof == structure_dof || interface.relative_to == structure_dof;
  });
}

void InterfaceMap::to_interface(const Eigen::Ref<const Eigen::VectorXd>& structure,
                                InterfaceVector& interface) const noexcept {
  HYBRIDTEST_ASSERT(structure.size() == structure_size_);
  if (interface.size() != size()) interface.resize(size());
  const double* const from = structure.data();
  double* to = interface.data();
  for (const auto [dof, base] : dofs_) *to++ = base == InterfaceDof::kGround ? from[dof] : from[dof] - from[base];
}

void InterfaceMap::add_to_structure(const Eigen::Ref<const Eigen::VectorXd>& interface_n,
                                    Eigen::Ref<Eigen::VectorXd> structure_n) const noexcept {
  HYBRIDTEST_ASSERT(interface_n.size() == size());
  HYBRIDTEST_ASSERT(structure_n.size() == structure_size_);
  for (Eigen::Index k = 0; k < size(); ++k) {
    const auto [dof, base] = dofs_[static_cast<std::size_t>(k)];
    structure_n[dof] += interface_n[k];
    if (base != InterfaceDof::kGround) structure_n[base] -= interface_n[k];
  }
}

Eigen::SparseMatrix<double> InterfaceMap::on_structure(const Eigen::MatrixXd& interface_n_per_m) const {
  HYBRIDTEST_ASSERT(interface_n_per_m.rows() == size() && interface_n_per_m.cols() == size());
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int row, int column, double value) {
    if (row != InterfaceDof::kGround && column != InterfaceDof::kGround) entries.emplace_back(row, column, value);
  };
  for (Eigen::Index k = 0; k < size(); ++k) {
    const auto [row, row_base] = dofs_[static_cast<std::size_t>(k)];
    for (Eigen::Index l = 0; l < size(); ++l) {
      const auto [column, column_base] = dofs_[static_cast<std::size_t>(l)];
      const double value = interface_n_per_m(k, l);
      if (value == 0.0) continue;  // springs between few of many degrees of freedom
      add(row, column, value);
      add(row_base, column, -value);
      add(row, column_base, -value);
      add(row_base, column_base, value);
    }
  }
  Eigen::SparseMatrix<double> structure(structure_size_, structure_size_);
  structure.setFromTriplets(entries.begin(), entries.end());
  return structure;
}

Eigen::MatrixXd InterfaceMap::matrix() const {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size(), structure_size_);
  for (Eigen::Index k = 0; k < size(); ++k) {
    const auto [dof, base] = dofs_[static_cast<std::size_t>(k)];
    matrix(k, dof) = 1.0;
    if (base != InterfaceDof::kGround) matrix(k, base) = -1.0;
  }
  return matrix;
}

}  // namespace hybridtest
