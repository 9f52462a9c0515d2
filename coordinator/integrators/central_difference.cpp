#include "coordinator/integrators/central_difference.hpp"

#include <string>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

SparseMatrix combined(const LinearStructure& structure, double step_s, double damping_sign) {
  SparseMatrix result =
      structure.mass_kg / (step_s * step_s) + structure.damping_n_s_per_m * (damping_sign / (2.0 * step_s));
  result.makeCompressed();
  return result;
}

}  // namespace

CentralDifference::CentralDifference(const LinearStructure& structure, double step_s, const InitialMotion& initial)
    : step_s_{step_s},
      mass_{require_integrable(structure, step_s).mass_kg, "mass"},
      effective_mass_{combined(structure, step_s, 1.0), "effective mass (M/dt^2 + C/2dt)"},
      difference_weight_{combined(structure, step_s, -1.0)},
      damping_{structure.damping_n_s_per_m},
      difference_{Eigen::VectorXd::Zero(structure.size())},
      next_difference_{Eigen::VectorXd::Zero(structure.size())},
      current_{starting_state(initial, structure.size())},
      completed_{current_} {}

void CentralDifference::start(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
                              const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept {
  next_difference_ = applied_force_n - restoring_force_n;
  next_difference_.noalias() -= damping_ * current_.velocity_m_per_s;
  mass_.solve_in_place(next_difference_);
  difference_ = step_s_ * current_.velocity_m_per_s - (0.5 * step_s_ * step_s_) * next_difference_;
  has_started_ = true;
}

void CentralDifference::advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
                                const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept {
  HYBRIDTEST_ASSERT(restoring_force_n.size() == difference_.size() && applied_force_n.size() == difference_.size());
  if (!has_started_) start(restoring_force_n, applied_force_n);
  next_difference_ = applied_force_n - restoring_force_n;
  next_difference_.noalias() += difference_weight_ * difference_;
  effective_mass_.solve_in_place(next_difference_);

  const double h = step_s_;
  for (Eigen::Index k = 0; k < difference_.size(); ++k) {
    const double velocity_m_per_s = (next_difference_[k] + difference_[k]) / (2.0 * h);
    const double acceleration_m_per_s2 = (next_difference_[k] - difference_[k]) / (h * h);
    completed_.displacement_m[k] = current_.displacement_m[k];
    completed_.velocity_m_per_s[k] = velocity_m_per_s;
    completed_.acceleration_m_per_s2[k] = acceleration_m_per_s2;
    current_.displacement_m[k] += next_difference_[k];
    current_.velocity_m_per_s[k] = velocity_m_per_s + h * acceleration_m_per_s2;
    current_.acceleration_m_per_s2[k] = acceleration_m_per_s2;
  }
  difference_.swap(next_difference_);
}

void CentralDifference::visit_state(const StateVisitor& visit) {
  visit_motion(current_, visit);
  visit(difference_);
}

}  // namespace hybridtest
