#include "coordinator/integrators/rosenbrock_w.hpp"

#include <numbers>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

constexpr double kGamma = 1.0 - 0.5 * std::numbers::sqrt2;

}  // namespace

RosenbrockW::RosenbrockW(const LinearStructure& structure, double step_s, const InitialMotion& initial)
    : step_s_{kNeeds.commands_per_step * step_s},
      mass_factor_{require_integrable(structure, step_s).mass_kg, "mass"},
      effective_mass_{weighted_sum(structure, 1.0, kGamma * step_s_, kGamma * step_s_ * kGamma * step_s_),
                      "effective mass (M, dt C and dt^2 K)"},
      damping_{structure.damping_n_s_per_m},
      stiffness_{structure.initial_stiffness_n_per_m},
      unbalance_n_{Eigen::VectorXd::Zero(structure.size())},
      displacement_change_{unbalance_n_},
      velocity_change_{unbalance_n_},
      shift_{unbalance_n_},
      current_{starting_state(initial, structure.size())},
      completed_{current_} {
  displacement_m_ = current_.displacement_m;
  velocity_m_per_s_ = current_.velocity_m_per_s;
}

void RosenbrockW::advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
                          const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept {
  HYBRIDTEST_ASSERT(restoring_force_n.size() == unbalance_n_.size() && applied_force_n.size() == unbalance_n_.size());
  unbalance_n_ = applied_force_n - restoring_force_n;
  unbalance_n_.noalias() -= damping_ * current_.velocity_m_per_s;
  completed_.displacement_m.swap(current_.displacement_m);  // the stages place the next command there
  completed_.velocity_m_per_s.swap(current_.velocity_m_per_s);
  completed_.acceleration_m_per_s2 = unbalance_n_;
  mass_factor_.solve_in_place(completed_.acceleration_m_per_s2);
  if (is_second_) {
    second_stage();
  } else {
    first_stage();
  }
  is_second_ = !is_second_;
  current_.acceleration_m_per_s2 = completed_.acceleration_m_per_s2;
}

/// Of [I - g h J] (a, b) = h (v, M^-1 G): a = h v + g h b, [M + g h C + (g h)^2 K_I] b = h (G - g h K_I v).
void RosenbrockW::first_stage() noexcept {
  shift_ = (kGamma * step_s_) * velocity_m_per_s_;
  unbalance_n_.noalias() -= stiffness_ * shift_;
  velocity_change_ = step_s_ * unbalance_n_;
  effective_mass_.solve_in_place(velocity_change_);
  const double h = step_s_;
  for (Eigen::Index k = 0; k < velocity_change_.size(); ++k) {
    displacement_change_[k] = h * velocity_m_per_s_[k] + (kGamma * h) * velocity_change_[k];
    current_.displacement_m[k] = displacement_m_[k] + 0.5 * displacement_change_[k];
    current_.velocity_m_per_s[k] = velocity_m_per_s_[k] + 0.5 * velocity_change_[k];
  }
}

/// The same with the right-hand side (s, h M^-1 [G_s + g (K_I a_1 + C b_1)]), s = h v_s - g h b_1.
void RosenbrockW::second_stage() noexcept {
  shift_ = kGamma * velocity_change_;
  unbalance_n_.noalias() += damping_ * shift_;
  const double h = step_s_;
  for (Eigen::Index k = 0; k < shift_.size(); ++k) {
    shift_[k] = h * completed_.velocity_m_per_s[k] - (kGamma * h) * velocity_change_[k];
    displacement_change_[k] = kGamma * (displacement_change_[k] - shift_[k]);
  }
  unbalance_n_.noalias() += stiffness_ * displacement_change_;
  velocity_change_ = step_s_ * unbalance_n_;
  effective_mass_.solve_in_place(velocity_change_);
  for (Eigen::Index k = 0; k < shift_.size(); ++k) {
    displacement_m_[k] += shift_[k] + (kGamma * h) * velocity_change_[k];
    velocity_m_per_s_[k] += velocity_change_[k];
    current_.displacement_m[k] = displacement_m_[k];
    current_.velocity_m_per_s[k] = velocity_m_per_s_[k];
  }
}

void RosenbrockW::visit_state(const StateVisitor& visit) {
  visit_motion(current_, visit);
  visit(displacement_m_);
  visit(velocity_m_per_s_);
  visit(displacement_change_);
  visit(velocity_change_);
}

}  // namespace hybridtest
