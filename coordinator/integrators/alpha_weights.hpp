#pragma once

#include <Eigen/SparseCore>

#include "mechanics/structure/linear_structure.hpp"

namespace hybridtest {

/// Weights of the generalised-alpha method by the spectral radius rho of infinitely fast modes (Chung and Hulbert,
/// 1993):
///
///   alpha_m = (2 rho - 1)/(1 + rho),   alpha_f = rho/(1 + rho),   gamma = 1/2 - alpha_m + alpha_f,
///   beta = (1/2 + gamma)^2/4.
struct AlphaWeights {
  explicit AlphaWeights(double rho_inf) noexcept;

  /// (1 - alpha_m) M + (1 - alpha_f) P, P = gamma h C + beta h^2 K_I for a step h: weights of the end of a step.
  [[nodiscard]] Eigen::SparseMatrix<double> end_matrix(const LinearStructure& structure, double step_s) const;
  /// alpha_m M + alpha_f P: of its beginning.
  [[nodiscard]] Eigen::SparseMatrix<double> begin_matrix(const LinearStructure& structure, double step_s) const;

  double alpha_m;
  double alpha_f;
  double gamma;
  double beta;
};

}  // namespace hybridtest
