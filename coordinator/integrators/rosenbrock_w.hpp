#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "coordinator/integrators/integrator.hpp"
#include "mechanics/structure/factorised_matrix.hpp"
#include "mechanics/structure/linear_structure.hpp"

namespace hybridtest {

/// Real-time compatible Rosenbrock-W method of two stages, LSRT2 (Bursi, Gonzalez-Buelga, Vulcan, Neild and Wagg,
/// Earthquake Engineering and Structural Dynamics 37, 2008), of y' = F(y, t) with y = (u, v):
///
///   k_1 = [I - g h J]^-1 h F(y_k, t_k),
///   k_2 = [I - g h J]^-1 h (F(y_k + k_1/2, t_k + h/2) - g J k_1),   y_{k+1} = y_k + k_2,   g = 1 - sqrt(2)/2,
///
/// J that of the initial stiffness K_I. Its step h holds two commands, u_k and the displacement of y_k + k_1/2, each a
/// step of the test apart: h = 2 dt. With J eliminated, a stage is one sparse solve with M + g h C + (g h)^2 K_I.
///
/// Second order in dt with any J; L-stable for r = K_I u: fast modes vanish in a step. Also stable where K
/// is less than K_I; where it exceeds K_I the excess may be a negative damping. Displacement and velocity of current()
/// are final; completed() adds the acceleration of equilibrium.
class RosenbrockW final : public Integrator {
 public:
  static constexpr IntegratorNeeds kNeeds{.initial_stiffness = true, .commands_per_step = 2};

  /// @param step_s   between commands, half the step of the method.
  /// @throws ConfigError as require_consistent(); for a step that is not positive; for an initial motion that does not
  ///         fit; when M + g h C + (g h)^2 K_I is singular.
  RosenbrockW(const LinearStructure& structure, double step_s, const InitialMotion& initial = {});

  [[nodiscard]] const MotionState& current() const noexcept override { return current_; }
  [[nodiscard]] const MotionState& completed() const noexcept override { return completed_; }
  void advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
               const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept override;
  void visit_state(const StateVisitor& visit) override;

 private:
  void first_stage() noexcept;
  void second_stage() noexcept;

  double step_s_;  // h
  FactorisedMatrix mass_factor_;
  FactorisedMatrix effective_mass_;  // M + g h C + (g h)^2 K_I
  Eigen::SparseMatrix<double> damping_;
  Eigen::SparseMatrix<double> stiffness_;
  Eigen::VectorXd unbalance_n_;          // f - r - C v of the stage
  Eigen::VectorXd displacement_m_;       // u_k
  Eigen::VectorXd velocity_m_per_s_;     // v_k
  Eigen::VectorXd displacement_change_;  // of k_1, then of k_2
  Eigen::VectorXd velocity_change_;
  Eigen::VectorXd shift_;
  bool is_second_ = false;  // the stage that waits for its force
  MotionState current_;
  MotionState completed_;
};

}  // namespace hybridtest
