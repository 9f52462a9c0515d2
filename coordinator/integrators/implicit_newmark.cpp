#include "coordinator/integrators/implicit_newmark.hpp"

#include "core/assert.hpp"
#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

namespace {
constexpr double kRounding = 1e-12;
}  // namespace

void ImplicitNewmark::Parameters::serialize(ParameterArchive& archive) {
  archive.optional("gamma", gamma,
                   {{.low = 0.5, .high = 1.0}, "1/2 damps no mode; more damps all, and the method is of first order"});
  archive.optional("beta", beta,
                   {{.low = (1.0 - kRounding) * 0.25 * (gamma + 0.5) * (gamma + 0.5), .high = 1.0},
                    "of the displacement; 1/4 is average acceleration",
                    "below (gamma + 1/2)^2/4 the method is not stable with any step",
                    "(`gamma` + 1/2)²/4 to 1"});
  archive.optional("tolerance_m", tolerance_m,
                   {kPositive, "the iterations of a step end when no degree of freedom is corrected by more"});
  archive.optional("iterations_max", iterations_max,
                   {{.low = 1.0, .high = 10000.0}, "trials in a step; without equilibrium by then, the test ends"});
}

ImplicitNewmark::ImplicitNewmark(const Parameters& parameters, const LinearStructure& structure, double step_s,
                                 const InitialMotion& initial)
    : parameters_{checked(parameters)},
      step_s_{step_s},
      mass_factor_{require_integrable(structure, step_s).mass_kg, "mass"},
      tangent_{weighted_sum(structure, 1.0 / (parameters.beta * step_s * step_s),
                            parameters.gamma / (parameters.beta * step_s), 1.0),
               "tangent (M/dt^2, C/dt and K)"},
      mass_{structure.mass_kg},
      damping_{structure.damping_n_s_per_m},
      unbalance_n_{Eigen::VectorXd::Zero(structure.size())},
      buffer_{unbalance_n_},
      current_{starting_state(initial, structure.size())},
      completed_{current_} {}

void ImplicitNewmark::advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
                              const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept {
  HYBRIDTEST_ASSERT(restoring_force_n.size() == buffer_.size() && applied_force_n.size() == buffer_.size());
  unbalance_n_ = applied_force_n - restoring_force_n;
  if (!has_started_) {
    start();
    predict();
    return;
  }
  unbalance_n_.noalias() -= mass_ * current_.acceleration_m_per_s2;
  unbalance_n_.noalias() -= damping_ * current_.velocity_m_per_s;
  correct();
  if (is_trial_) {
    judge();
  } else {
    completed_ = current_;
    predict();
  }
}

void ImplicitNewmark::visit_state(const StateVisitor& visit) {
  visit_motion(current_, visit);
  visit_motion(completed_, visit);
}

void ImplicitNewmark::start() noexcept {
  completed_ = current_;
  unbalance_n_.noalias() -= damping_ * current_.velocity_m_per_s;
  completed_.acceleration_m_per_s2 = unbalance_n_;
  mass_factor_.solve_in_place(completed_.acceleration_m_per_s2);
  has_started_ = true;
}

/// A Newton iteration from the displacement of the last step, whose force and load are known.
void ImplicitNewmark::predict() noexcept {
  current_.displacement_m = completed_.displacement_m;
  follow_displacement();
  buffer_ = completed_.acceleration_m_per_s2 - current_.acceleration_m_per_s2;
  unbalance_n_.noalias() = mass_ * buffer_;
  buffer_ = completed_.velocity_m_per_s - current_.velocity_m_per_s;
  unbalance_n_.noalias() += damping_ * buffer_;
  correct();
  iteration_ = 0;
  is_trial_ = true;
  missing_m_ = 0.0;
}

void ImplicitNewmark::correct() noexcept {
  tangent_.solve_in_place(unbalance_n_);
  current_.displacement_m += unbalance_n_;
  follow_displacement();
}

/// Whether the corrected displacement is tried again.
void ImplicitNewmark::judge() noexcept {
  ++iteration_;
  const double correction_m = unbalance_n_.cwiseAbs().maxCoeff();
  const bool is_balanced = correction_m <= parameters_.tolerance_m;
  is_trial_ = !is_balanced && iteration_ < parameters_.iterations_max;
  if (!is_balanced && !is_trial_) missing_m_ = correction_m;
}

void ImplicitNewmark::follow_displacement() noexcept {
  const double h = step_s_;
  const auto& [gamma, beta, tolerance_m, iterations_max] = parameters_;
  const double of_change_per_s = gamma / (beta * h);
  const double of_velocity = 1.0 - gamma / beta;
  const double of_acceleration_s = h * (1.0 - 0.5 * gamma / beta);
  for (Eigen::Index k = 0; k < buffer_.size(); ++k) {
    const double change_m = current_.displacement_m[k] - completed_.displacement_m[k];
    const double v = completed_.velocity_m_per_s[k];
    const double a = completed_.acceleration_m_per_s2[k];
    current_.velocity_m_per_s[k] = of_change_per_s * change_m + of_velocity * v + of_acceleration_s * a;
    current_.acceleration_m_per_s2[k] = change_m / (beta * h * h) - v / (beta * h) - (0.5 / beta - 1.0) * a;
  }
}

}  // namespace hybridtest
