#include "coordinator/integrators/explicit_newmark.hpp"

#include <utility>

#include "core/assert.hpp"

namespace hybridtest {

ExplicitNewmark::ExplicitNewmark(const LinearStructure& structure, double step_s, const InitialMotion& initial)
    : step_s_{step_s},
      mass_{require_integrable(structure, step_s).mass_kg, "mass"},
      effective_mass_{weighted_sum(structure, 1.0, 0.5 * step_s, 0.0), "effective mass (M + dt/2 C)"},
      damping_{structure.damping_n_s_per_m},
      acceleration_{Eigen::VectorXd::Zero(structure.size())},
      current_{starting_state(initial, structure.size())},
      completed_{current_} {
  half_step_velocity_ = current_.velocity_m_per_s;
}

void ExplicitNewmark::advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
                              const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept {
  HYBRIDTEST_ASSERT(restoring_force_n.size() == acceleration_.size() && applied_force_n.size() == acceleration_.size());
  acceleration_ = applied_force_n - restoring_force_n;
  acceleration_.noalias() -= damping_ * half_step_velocity_;
  if (has_started_) {
    effective_mass_.solve_in_place(acceleration_);
  } else {
    mass_.solve_in_place(acceleration_);
  }

  const double h = step_s_;
  const bool has_half_step = std::exchange(has_started_, true);
  for (Eigen::Index k = 0; k < acceleration_.size(); ++k) {
    const double acceleration_m_per_s2 = acceleration_[k];
    double velocity_m_per_s = half_step_velocity_[k];
    if (has_half_step) velocity_m_per_s += (0.5 * h) * acceleration_m_per_s2;
    completed_.displacement_m[k] = current_.displacement_m[k];
    completed_.velocity_m_per_s[k] = velocity_m_per_s;
    completed_.acceleration_m_per_s2[k] = acceleration_m_per_s2;
    half_step_velocity_[k] = velocity_m_per_s + (0.5 * h) * acceleration_m_per_s2;
    current_.displacement_m[k] += h * half_step_velocity_[k];
    current_.velocity_m_per_s[k] = velocity_m_per_s + h * acceleration_m_per_s2;
    current_.acceleration_m_per_s2[k] = acceleration_m_per_s2;
  }
}

void ExplicitNewmark::visit_state(const StateVisitor& visit) {
  visit_motion(current_, visit);
  visit(half_step_velocity_);
}

}  // namespace hybridtest
