#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "coordinator/integrators/integrator.hpp"
#include "mechanics/structure/factorised_matrix.hpp"
#include "mechanics/structure/linear_structure.hpp"

namespace hybridtest {

/// Newmark's method with beta = 0 and gamma = 1/2 (Newmark, 1959):
///
///   M a_i + C v_i + r_i = f_i,
///   v_i     = v_{i-1} + dt/2 (a_{i-1} + a_i),
///   u_{i+1} = u_i + dt v_i + dt^2/2 a_i,
///
/// so that a_i comes from [M + dt/2 C] a_i = f_i - r_i - C (v_{i-1} + dt/2 a_{i-1}), and at step 0
/// from M a_0 = f_0 - r_0 - C v_0. Its displacements are those of central differences in exact
/// arithmetic; it starts itself and carries velocity and acceleration along.
///
/// Second order in dt; explicit in r, implicit in C. Stable for dt <= 2/omega of the highest
/// mode, see require_stable_step(). completed() is in equilibrium at step i. current() predicts
/// along the parabola that also gives its displacement: a is a_i kept, v is v_i + dt a_i.
class ExplicitNewmark final : public Integrator {
 public:
  static constexpr IntegratorNeeds kNeeds{};

  /// @throws ConfigError as require_consistent(); for a step that is not positive; for an initial
  ///         motion that does not fit; when M + dt/2 C is singular.
  ExplicitNewmark(const LinearStructure& structure, double step_s, const InitialMotion& initial = {});

  [[nodiscard]] const MotionState& current() const noexcept override { return current_; }
  [[nodiscard]] const MotionState& completed() const noexcept override { return completed_; }
  void advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
               const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept override;
  void visit_state(const StateVisitor& visit) override;

 private:
  double step_s_;
  FactorisedMatrix mass_;
  FactorisedMatrix effective_mass_;  // M + dt/2 C
  Eigen::SparseMatrix<double> damping_;
  Eigen::VectorXd half_step_velocity_;  // v_{i-1} + dt/2 a_{i-1}; at step 0 the initial velocity
  Eigen::VectorXd acceleration_;
  bool has_started_ = false;
  MotionState current_;
  MotionState completed_;
};

}  // namespace hybridtest
