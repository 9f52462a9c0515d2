#include "coordinator/integrators/alpha_weights.hpp"

#include "coordinator/integrators/integrator.hpp"

namespace hybridtest {

AlphaWeights::AlphaWeights(double rho_inf) noexcept
    : alpha_m{(2.0 * rho_inf - 1.0) / (1.0 + rho_inf)},
      alpha_f{rho_inf / (1.0 + rho_inf)},
      gamma{0.5 - alpha_m + alpha_f},
      beta{0.25 * (0.5 + gamma) * (0.5 + gamma)} {}

Eigen::SparseMatrix<double> AlphaWeights::end_matrix(const LinearStructure& structure, double step_s) const {
  const double share = 1.0 - alpha_f;
  return weighted_sum(structure, 1.0 - alpha_m, share * gamma * step_s, share * beta * step_s * step_s);
}

Eigen::SparseMatrix<double> AlphaWeights::begin_matrix(const LinearStructure& structure, double step_s) const {
  return weighted_sum(structure, alpha_m, alpha_f * gamma * step_s, alpha_f * beta * step_s * step_s);
}

}  // namespace hybridtest
