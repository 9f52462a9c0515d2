#pragma once

#include <Eigen/Core>
#include <functional>
#include <stdexcept>

#include "coordinator/integrators/integrator.hpp"
#include "mechanics/structure/factorised_matrix.hpp"

namespace hybridtest::test {

/// The restoring force of a structure with a history.
struct TrialForce {
  std::function<Eigen::VectorXd(const Eigen::VectorXd& displacement_m)> trial;  // [N], from the last commit
  std::function<void()> commit = [] {};                                         // makes the last trial the history
};

/// A reference of our own: Newmark's average acceleration (Newmark, 1959), in each step iterated to equilibrium with
/// the initial stiffness. What the integrators of a test cannot do, which has one force per step.
class ImplicitNewmark {
 public:
  ImplicitNewmark(const LinearStructure& structure, double step_s, TrialForce force, const Eigen::VectorXd& applied_n,
                  const InitialMotion& initial = {})
      : structure_{require_integrable(structure, step_s)},
        step_s_{step_s},
        force_{std::move(force)},
        tangent_{weighted_sum(structure, 4.0 / (step_s * step_s), 2.0 / step_s, 1.0), "tangent"},
        state_{starting_state(initial, structure.size())} {
    state_.acceleration_m_per_s2 =
        applied_n - force_.trial(state_.displacement_m) - structure.damping_n_s_per_m * state_.velocity_m_per_s;
    FactorisedMatrix{structure.mass_kg, "mass"}.solve_in_place(state_.acceleration_m_per_s2);
    force_.commit();
  }

  [[nodiscard]] const MotionState& state() const noexcept { return state_; }

  /// @param applied_n   at the end of the step.
  /// @throws std::runtime_error without equilibrium.
  void advance(const Eigen::VectorXd& applied_n) {
    const MotionState before = state_;
    Eigen::VectorXd change;
    double largest = 0.0;
    for (int iteration = 0; iteration < kIterationsMax; ++iteration) {
      const Eigen::VectorXd moved = state_.displacement_m - before.displacement_m;
      state_.velocity_m_per_s = 2.0 / step_s_ * moved - before.velocity_m_per_s;
      state_.acceleration_m_per_s2 =
          4.0 / (step_s_ * step_s_) * moved - 4.0 / step_s_ * before.velocity_m_per_s - before.acceleration_m_per_s2;
      change = applied_n - force_.trial(state_.displacement_m) -
               structure_.damping_n_s_per_m * state_.velocity_m_per_s -
               structure_.mass_kg * state_.acceleration_m_per_s2;
      tangent_.solve_in_place(change);
      const double size = change.cwiseAbs().maxCoeff();
      largest = std::max(largest, size);
      if (size <= kTolerance * largest + kRounding * state_.displacement_m.cwiseAbs().maxCoeff()) {
        force_.commit();
        return;
      }
      state_.displacement_m += change;
    }
    throw std::runtime_error{"no equilibrium in a step of the implicit reference"};
  }

 private:
  static constexpr int kIterationsMax = 1000;
  static constexpr double kTolerance = 1e-10;  // of the largest correction of the step
  static constexpr double kRounding = 1e-14;   // of a displacement

  LinearStructure structure_;
  double step_s_;
  TrialForce force_;
  FactorisedMatrix tangent_;  // 4/dt^2 M + 2/dt C + K_I
  MotionState state_;
};

}  // namespace hybridtest::test
