#include "coordinator/integrators/generalised_alpha.hpp"

#include "core/assert.hpp"
#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

GeneralisedAlpha::GeneralisedAlpha(const Parameters& parameters, const LinearStructure& structure, double step_s,
                                   const InitialMotion& initial)
    : weights_{checked(parameters).rho_inf},
      iterations_{parameters.iterations},
      step_s_{iterations_ * step_s},
      mass_factor_{require_integrable(structure, step_s).mass_kg, "mass"},
      effective_mass_{weights_.end_matrix(structure, step_s_), "effective mass (M, dt C and dt^2 K)"},
      mass_{structure.mass_kg},
      damping_{structure.damping_n_s_per_m},
      stiffness_{structure.initial_stiffness_n_per_m},
      begin_{starting_state(initial, structure.size())},
      end_{begin_},
      balanced_{begin_.acceleration_m_per_s2},
      displacement_before_m_{balanced_},
      predicted_displacement_m_{balanced_},
      predicted_velocity_m_per_s_{balanced_},
      constant_n_{balanced_},
      unbalance_n_{balanced_},
      buffer_{balanced_},
      current_{begin_},
      completed_{begin_} {}

void GeneralisedAlpha::advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
                               const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept {
  HYBRIDTEST_ASSERT(restoring_force_n.size() == balanced_.size() && applied_force_n.size() == balanced_.size());
  unbalance_n_ = applied_force_n - restoring_force_n;
  if (iteration_ == 0) {
    start();
  } else {
    find_end();
    if (iteration_ < iterations_) {
      complete();
    } else {
      end_step();
    }
  }
  if (iteration_ == 0) {
    predict_end();
    find_end();
  }
  ++iteration_;
  place_command();
}

void GeneralisedAlpha::start() noexcept {
  complete();
  begin_ = completed_;
  current_.displacement_m = begin_.displacement_m;
  balanced_ = begin_.acceleration_m_per_s2;
  displacement_before_m_ =
      begin_.displacement_m - step_s_ * begin_.velocity_m_per_s + (0.5 * step_s_ * step_s_) * balanced_;
}

/// The command as it was, with the acceleration that the newest force leaves; the next command takes its place.
void GeneralisedAlpha::complete() noexcept {
  completed_.displacement_m.swap(current_.displacement_m);
  completed_.velocity_m_per_s.swap(current_.velocity_m_per_s);
  completed_.acceleration_m_per_s2 = unbalance_n_;
  completed_.acceleration_m_per_s2.noalias() -= damping_ * completed_.velocity_m_per_s;
  mass_factor_.solve_in_place(completed_.acceleration_m_per_s2);
}

/// With a' = 0, and what is the same at each command of the step.
void GeneralisedAlpha::predict_end() noexcept {
  const double h = step_s_;
  predicted_displacement_m_ = begin_.displacement_m + h * begin_.velocity_m_per_s +
                              ((0.5 - weights_.beta) * h * h) * begin_.acceleration_m_per_s2;
  predicted_velocity_m_per_s_ = begin_.velocity_m_per_s + ((1.0 - weights_.gamma) * h) * begin_.acceleration_m_per_s2;
  buffer_ = (weights_.alpha_f * balanced_ - weights_.alpha_m * begin_.acceleration_m_per_s2) / (1.0 - weights_.alpha_f);
  constant_n_.noalias() = mass_ * buffer_;
  constant_n_.noalias() -= stiffness_ * predicted_displacement_m_;
  constant_n_.noalias() -= damping_ * predicted_velocity_m_per_s_;
}

/// With the a' of equilibrium.
void GeneralisedAlpha::find_end() noexcept {
  Eigen::VectorXd& solved = end_.acceleration_m_per_s2;
  solved = unbalance_n_ + constant_n_;
  solved.noalias() += stiffness_ * current_.displacement_m;
  solved *= 1.0 - weights_.alpha_f;
  effective_mass_.solve_in_place(solved);
  const double h = step_s_;
  const double of_displacement_s2 = weights_.beta * h * h;
  const double of_velocity_s = weights_.gamma * h;
  for (Eigen::Index k = 0; k < solved.size(); ++k) {
    end_.displacement_m[k] = predicted_displacement_m_[k] + of_displacement_s2 * solved[k];
    end_.velocity_m_per_s[k] = predicted_velocity_m_per_s_[k] + of_velocity_s * solved[k];
  }
}

void GeneralisedAlpha::end_step() noexcept {
  balanced_ = ((1.0 - weights_.alpha_m) * end_.acceleration_m_per_s2 + weights_.alpha_m * begin_.acceleration_m_per_s2 -
               weights_.alpha_f * balanced_) /
              (1.0 - weights_.alpha_f);
  displacement_before_m_.swap(begin_.displacement_m);
  begin_.displacement_m = completed_.displacement_m = end_.displacement_m;
  begin_.velocity_m_per_s = completed_.velocity_m_per_s = end_.velocity_m_per_s;
  begin_.acceleration_m_per_s2.swap(end_.acceleration_m_per_s2);
  completed_.acceleration_m_per_s2 = balanced_;
  iteration_ = 0;
}

/// On the parabola through the displacements at -1, 0 and 1, at x of the step.
void GeneralisedAlpha::place_command() noexcept {
  const double x = static_cast<double>(iteration_) / iterations_;
  const double h = step_s_;
  const double rate_before = (x - 0.5) / h;
  const double rate_begin = 2.0 * x / h;
  const double rate_end = (x + 0.5) / h;
  for (Eigen::Index k = 0; k < displacement_before_m_.size(); ++k) {
    const double before_m = displacement_before_m_[k];
    const double begin_m = begin_.displacement_m[k];
    const double end_m = end_.displacement_m[k];
    current_.displacement_m[k] =
        (0.5 * x * (x - 1.0)) * before_m + (1.0 - x * x) * begin_m + (0.5 * x * (x + 1.0)) * end_m;
    current_.velocity_m_per_s[k] = rate_before * before_m - rate_begin * begin_m + rate_end * end_m;
    current_.acceleration_m_per_s2[k] = (before_m - 2.0 * begin_m + end_m) / (h * h);
  }
}

void GeneralisedAlpha::visit_state(const StateVisitor& visit) {
  visit_motion(current_, visit);
  visit_motion(begin_, visit);
  visit(balanced_);
  visit(displacement_before_m_);
  visit(predicted_displacement_m_);
  visit(predicted_velocity_m_per_s_);
  visit(constant_n_);
}

}  // namespace hybridtest
