#include "mechanics/structure/energy_balance.hpp"

#include <utility>

namespace hybridtest {

EnergyBalance::EnergyBalance(const Eigen::SparseMatrix<double>& mass_kg,
                             const Eigen::SparseMatrix<double>& damping_n_s_per_m)
    : mass_kg_{mass_kg}, damping_n_s_per_m_{damping_n_s_per_m} {}

void EnergyBalance::add(const Eigen::Ref<const Eigen::VectorXd>& displacement_m,
                        const Eigen::Ref<const Eigen::VectorXd>& velocity_m_per_s,
                        const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
                        const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) {
  Forces now{displacement_m, damping_n_s_per_m_ * velocity_m_per_s, restoring_force_n, applied_force_n};
  energy_.kinetic_j = 0.5 * velocity_m_per_s.dot(mass_kg_ * velocity_m_per_s);
  if (before_) {
    const Eigen::VectorXd increment_m = now.displacement_m - before_->displacement_m;
    energy_.damping_j += 0.5 * (before_->damping_n + now.damping_n).dot(increment_m);
    energy_.restoring_j += 0.5 * (before_->restoring_n + now.restoring_n).dot(increment_m);
    energy_.input_j += 0.5 * (before_->applied_n + now.applied_n).dot(increment_m);
  } else {
    energy_.input_j = energy_.kinetic_j;
  }
  before_ = std::move(now);
}

}  // namespace hybridtest
