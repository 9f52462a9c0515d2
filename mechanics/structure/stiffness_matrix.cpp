#include "mechanics/structure/stiffness_matrix.hpp"

#include <cmath>
#include <string>

#include "core/config_error.hpp"
#include "core/text/scalar.hpp"

namespace hybridtest {
namespace {

std::string entry(const Eigen::MatrixXd& matrix, Eigen::Index row, Eigen::Index column) {
  return "(" + std::to_string(row + 1) + ", " + std::to_string(column + 1) + ") is " +
         written_number(matrix(row, column));
}

}  // namespace

InterfaceMatrix checked_stiffness(const Eigen::MatrixXd& stiffness_n_per_m) {
  const Eigen::Index size = stiffness_n_per_m.rows();
  if (size != stiffness_n_per_m.cols() || size < 1 || size > kMaxInterfaceDofs) {
    throw ConfigError{"stiffness has " + std::to_string(size) + " rows and " +
                      std::to_string(stiffness_n_per_m.cols()) + " columns; expected a square matrix of 1 to " +
                      std::to_string(kMaxInterfaceDofs)};
  }
  for (Eigen::Index column = 0; column < size; ++column) {
    for (Eigen::Index row = 0; row < size; ++row) {
      if (std::isfinite(stiffness_n_per_m(row, column))) continue;
      throw ConfigError{"stiffness entry (" + std::to_string(row + 1) + ", " + std::to_string(column + 1) +
                        ") is not a finite number"};
    }
  }
  const double tolerance = kSymmetryTolerance * stiffness_n_per_m.cwiseAbs().maxCoeff();
  for (Eigen::Index column = 0; column < size; ++column) {
    for (Eigen::Index row = column + 1; row < size; ++row) {
      if (std::abs(stiffness_n_per_m(row, column) - stiffness_n_per_m(column, row)) <= tolerance) continue;
      throw ConfigError{"stiffness entry " + entry(stiffness_n_per_m, row, column) + " and entry " +
                        entry(stiffness_n_per_m, column, row) + "; expected a symmetric matrix"};
    }
  }
  return 0.5 * stiffness_n_per_m + 0.5 * stiffness_n_per_m.transpose();
}

}  // namespace hybridtest
