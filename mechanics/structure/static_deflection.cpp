#include "mechanics/structure/static_deflection.hpp"

#include "mechanics/structure/factorised_matrix.hpp"

namespace hybridtest {

Eigen::VectorXd static_deflection(const Eigen::SparseMatrix<double>& stiffness_n_per_m,
                                  const std::vector<Eigen::Index>& given, const Eigen::VectorXd& displacement_m) {
  const Eigen::Index size = stiffness_n_per_m.rows();
  std::vector<Eigen::Index> place(static_cast<std::size_t>(size), 0);  // among the others; -1: given
  for (const Eigen::Index dof : given) place[static_cast<std::size_t>(dof)] = -1;
  Eigen::Index others = 0;
  for (Eigen::Index& at : place) {
    if (at == 0) at = others++;
  }
  Eigen::VectorXd deflection = displacement_m;
  if (others == 0) return deflection;
  Eigen::VectorXd force_n = Eigen::VectorXd::Zero(others);
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index column = 0; column < size; ++column) {
    const Eigen::Index to = place[static_cast<std::size_t>(column)];
    for (Eigen::SparseMatrix<double>::InnerIterator entry{stiffness_n_per_m, column}; entry; ++entry) {
      const Eigen::Index from = place[static_cast<std::size_t>(entry.row())];
      if (from < 0) continue;
      if (to < 0) {
        force_n[from] -= entry.value() * displacement_m[column];
      } else {
        entries.emplace_back(from, to, entry.value());
      }
    }
  }
  Eigen::SparseMatrix<double> held(others, others);
  held.setFromTriplets(entries.begin(), entries.end());
  FactorisedMatrix{held, "stiffness of what is not given"}.solve_in_place(force_n);
  for (Eigen::Index dof = 0; dof < size; ++dof) {
    const Eigen::Index at = place[static_cast<std::size_t>(dof)];
    if (at >= 0) deflection[dof] = force_n[at];
  }
  return deflection;
}

}  // namespace hybridtest
