#include "coordinator/integrators/kr_alpha.hpp"

#include "core/assert.hpp"
#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

KrAlpha::KrAlpha(const Parameters& parameters, const LinearStructure& structure, double step_s,
                 const InitialMotion& initial)
    : weights_{checked(parameters).rho_inf},
      step_s_{step_s},
      mass_{require_integrable(structure, step_s).mass_kg},
      mass_factor_{structure.mass_kg, "mass"},
      effective_mass_{weights_.end_matrix(structure, step_s), "effective mass (M, dt C and dt^2 K)"},
      old_weight_{weights_.begin_matrix(structure, step_s)},
      damping_{structure.damping_n_s_per_m},
      unbalance_n_{Eigen::VectorXd::Zero(structure.size())},
      memory_n_{unbalance_n_},
      weighted_{unbalance_n_},
      current_{starting_state(initial, structure.size())},
      completed_{current_} {
  late_velocity_m_per_s_ = current_.velocity_m_per_s;
  start_force_n_ = weights_.gamma * step_s * (structure.initial_stiffness_n_per_m * current_.velocity_m_per_s);
}

void KrAlpha::advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
                      const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept {
  HYBRIDTEST_ASSERT(restoring_force_n.size() == weighted_.size() && applied_force_n.size() == weighted_.size());
  unbalance_n_ = applied_force_n - restoring_force_n;
  completed_.displacement_m = current_.displacement_m;
  if (has_started_) {
    take_step();
  } else {
    start();
  }
  const double h = step_s_;
  for (Eigen::Index k = 0; k < weighted_.size(); ++k) {
    const double velocity_m_per_s = completed_.velocity_m_per_s[k];
    current_.displacement_m[k] += h * velocity_m_per_s + (0.5 * h * h) * weighted_[k];
    current_.velocity_m_per_s[k] = velocity_m_per_s + h * weighted_[k];
    current_.acceleration_m_per_s2[k] = weighted_[k];
    late_velocity_m_per_s_[k] += h * weighted_[k];
  }
}

/// Any w_0 within O(dt) of the acceleration keeps the order; this one bounds fast modes and, with rho_inf = 1, gives
/// free vibration the first step of average acceleration.
void KrAlpha::start() noexcept {
  unbalance_n_.noalias() -= damping_ * current_.velocity_m_per_s;
  completed_.velocity_m_per_s = current_.velocity_m_per_s;
  completed_.acceleration_m_per_s2 = unbalance_n_;
  mass_factor_.solve_in_place(completed_.acceleration_m_per_s2);

  weighted_ = (1.0 - weights_.alpha_m) * (unbalance_n_ - start_force_n_);
  effective_mass_.solve_in_place(weighted_);
  memory_n_.noalias() = mass_ * weighted_;
  memory_n_ *= weights_.alpha_f - weights_.alpha_m;
  late_velocity_m_per_s_ = current_.velocity_m_per_s - weights_.gamma * step_s_ * weighted_;
  has_started_ = true;
}

void KrAlpha::take_step() noexcept {
  completed_.acceleration_m_per_s2 = unbalance_n_;
  unbalance_n_.noalias() -= damping_ * late_velocity_m_per_s_;
  weighted_ = (1.0 - weights_.alpha_f) * unbalance_n_ + memory_n_;
  effective_mass_.solve_in_place(weighted_);
  if (weights_.alpha_f != weights_.alpha_m) {
    memory_n_.noalias() = old_weight_ * weighted_;
    memory_n_ = weights_.alpha_f * unbalance_n_ - memory_n_;
  }
  completed_.velocity_m_per_s = late_velocity_m_per_s_ + (weights_.gamma * step_s_) * weighted_;
  completed_.acceleration_m_per_s2.noalias() -= damping_ * completed_.velocity_m_per_s;
  mass_factor_.solve_in_place(completed_.acceleration_m_per_s2);
}

void KrAlpha::visit_state(const StateVisitor& visit) {
  visit_motion(current_, visit);
  visit(memory_n_);
  visit(late_velocity_m_per_s_);
}

}  // namespace hybridtest
