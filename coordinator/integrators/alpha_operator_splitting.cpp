#include "coordinator/integrators/alpha_operator_splitting.hpp"

#include "core/assert.hpp"
#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

AlphaOperatorSplitting::Weights::Weights(double alpha_given) noexcept
    : alpha{alpha_given}, beta{0.25 * (1.0 - alpha) * (1.0 - alpha)}, gamma{0.5 * (1.0 - 2.0 * alpha)} {}

AlphaOperatorSplitting::AlphaOperatorSplitting(const Parameters& parameters, const LinearStructure& structure,
                                               double step_s, const InitialMotion& initial)
    : AlphaOperatorSplitting{Weights{checked(parameters).alpha}, require_integrable(structure, step_s), step_s,
                             initial} {}

AlphaOperatorSplitting::AlphaOperatorSplitting(const Weights& weights, const LinearStructure& structure, double step_s,
                                               const InitialMotion& initial)
    : weights_{weights},
      step_s_{step_s},
      mass_{structure.mass_kg},
      mass_factor_{structure.mass_kg, "mass"},
      effective_mass_{weighted_sum(structure, 1.0, (1.0 + weights.alpha) * weights.gamma * step_s,
                                   (1.0 + weights.alpha) * weights.beta * step_s * step_s),
                      "effective mass (M, dt C and dt^2 K)"},
      damping_{structure.damping_n_s_per_m},
      acceleration_{Eigen::VectorXd::Zero(structure.size())},
      right_hand_side_n_{acceleration_},
      current_{starting_state(initial, structure.size())},
      completed_{current_} {
  predicted_velocity_m_per_s_ = current_.velocity_m_per_s;
}

void AlphaOperatorSplitting::advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
                                     const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept {
  HYBRIDTEST_ASSERT(restoring_force_n.size() == acceleration_.size() && applied_force_n.size() == acceleration_.size());
  right_hand_side_n_ = applied_force_n - restoring_force_n;
  right_hand_side_n_.noalias() -= damping_ * predicted_velocity_m_per_s_;
  if (has_started_) {
    correct();
  } else {
    start();
  }
  predict();
}

void AlphaOperatorSplitting::start() noexcept {
  acceleration_ = right_hand_side_n_;
  mass_factor_.solve_in_place(acceleration_);
  completed_ = current_;
  completed_.acceleration_m_per_s2 = acceleration_;
  has_started_ = true;
}

void AlphaOperatorSplitting::correct() noexcept {
  acceleration_.noalias() = mass_ * completed_.acceleration_m_per_s2;
  acceleration_ = (1.0 + weights_.alpha) * right_hand_side_n_ - weights_.alpha * acceleration_;
  effective_mass_.solve_in_place(acceleration_);
  const double h = step_s_;
  const auto [alpha, beta, gamma] = weights_;
  for (Eigen::Index k = 0; k < acceleration_.size(); ++k) {
    const double a = acceleration_[k];
    completed_.displacement_m[k] = current_.displacement_m[k] + (beta * h * h) * a;
    completed_.velocity_m_per_s[k] = predicted_velocity_m_per_s_[k] + (gamma * h) * a;
    completed_.acceleration_m_per_s2[k] = (a + alpha * completed_.acceleration_m_per_s2[k]) / (1.0 + alpha);
  }
}

void AlphaOperatorSplitting::predict() noexcept {
  const double h = step_s_;
  const auto [alpha, beta, gamma] = weights_;
  for (Eigen::Index k = 0; k < acceleration_.size(); ++k) {
    const double a = acceleration_[k];
    const double v = completed_.velocity_m_per_s[k];
    current_.displacement_m[k] = completed_.displacement_m[k] + h * v + ((0.5 - beta) * h * h) * a;
    predicted_velocity_m_per_s_[k] = v + ((1.0 - gamma) * h) * a;
    current_.velocity_m_per_s[k] = v + h * a;
    current_.acceleration_m_per_s2[k] = a;
  }
}

void AlphaOperatorSplitting::visit_state(const StateVisitor& visit) {
  visit_motion(current_, visit);
  visit(completed_.acceleration_m_per_s2);
  visit(predicted_velocity_m_per_s_);
}

}  // namespace hybridtest
