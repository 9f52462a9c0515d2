#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "coordinator/integrators/integrator.hpp"
#include "mechanics/structure/factorised_matrix.hpp"
#include "mechanics/structure/linear_structure.hpp"

namespace hybridtest {

/// Central differences (Newmark, 1959; Chopra, Dynamics of Structures, section 5.3):
///
///   u_{i+1} = [M/dt^2 + C/2dt]^-1 [2M/dt^2 u_i + (C/2dt - M/dt^2) u_{i-1} - r_i + f_i],
///   u_{-1}  = u_0 - dt v_0 + dt^2/2 a_0,   M a_0 = f_0 - r_0 - C v_0.
///
/// Carried as the difference d_{i+1} = u_{i+1} - u_i, which is the same equation,
///
///   [M/dt^2 + C/2dt] d_{i+1} = (M/dt^2 - C/2dt) d_i - r_i + f_i,
///
/// without subtracting large equal displacements (summed form; Henrici, 1962), so that rounding
/// does not grow with the square of the number of steps.
///
/// Second order in dt; explicit in r, implicit in C. Stable for dt <= 2/omega of the highest
/// mode, see require_stable_step(). completed() holds v_i = (u_{i+1} - u_{i-1})/2dt and
/// a_i = (u_{i+1} - 2u_i + u_{i-1})/dt^2, which satisfy the equation of motion at step i.
/// current() predicts along the parabola through its displacement and the two before: a is
/// a_i kept, v is v_i + dt a_i.
class CentralDifference final : public Integrator {
 public:
  static constexpr IntegratorNeeds kNeeds{};

  /// @throws ConfigError as require_consistent(); for a step that is not positive; for an initial
  ///         motion that does not fit; when M/dt^2 + C/2dt is singular.
  CentralDifference(const LinearStructure& structure, double step_s, const InitialMotion& initial = {});

  [[nodiscard]] const MotionState& current() const noexcept override { return current_; }
  [[nodiscard]] const MotionState& completed() const noexcept override { return completed_; }
  void advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
               const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept override;
  void visit_state(const StateVisitor& visit) override;

 private:
  void start(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
             const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept;

  double step_s_;
  FactorisedMatrix mass_;
  FactorisedMatrix effective_mass_;                // M/dt^2 + C/2dt
  Eigen::SparseMatrix<double> difference_weight_;  // M/dt^2 - C/2dt
  Eigen::SparseMatrix<double> damping_;
  Eigen::VectorXd difference_;       // d_i = u_i - u_{i-1}
  Eigen::VectorXd next_difference_;  // d_{i+1}
  bool has_started_ = false;
  MotionState current_;
  MotionState completed_;
};

}  // namespace hybridtest
