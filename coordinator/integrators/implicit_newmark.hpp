#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "coordinator/integrators/integrator.hpp"
#include "core/parameters/parameter_archive.hpp"
#include "mechanics/structure/factorised_matrix.hpp"
#include "mechanics/structure/linear_structure.hpp"

namespace hybridtest {

/// Newmark's implicit method (Newmark, 1959), by default average acceleration, with equilibrium at the end of each
/// step:
///
///   M a' + C v' + r(u') = f',   v' = v + dt [(1 - gamma) a + gamma a'],   u' = u + dt v + dt^2 [(1/2 - beta) a + beta
///   a'].
///
/// Modified Newton iterations with the initial stiffness K_I. A displacement u_k is tried; its force r_k leaves
///
///   u_{k+1} = u_k + A^-1 [f' - r_k - C v_k - M a_k],   A = M/(beta dt^2) + gamma/(beta dt) C + K_I,
///
/// until no entry of the correction exceeds the tolerance. Then u_{k+1} is commanded for good, and its force corrects
/// the end of the step once more, by less than the tolerance: completed() is in equilibrium with that force plus K_I
/// times the correction. The first displacement tried is the end of the step by K_I and the load of the step before.
///
/// Each trial starts from the state at the end of the step before: substructures must be able to go back to it.
///
/// Second order in dt with gamma = 1/2, first order otherwise; stable with any step for beta at least (gamma +
/// 1/2)^2/4. A correction shrinks by |K_I - K|/A in each iteration, with the tangent stiffness K of the substructures:
/// iterations converge where K is at most K_I, and beyond it while K - K_I stays below A. Dampers among the
/// substructures count as gamma/(beta dt) c in K. Without damping in the step, average acceleration conserves the
/// energy of linear structures.
class ImplicitNewmark final : public Integrator {
 public:
  struct Parameters {
    double gamma = 0.5;
    double beta = 0.25;
    double tolerance_m = 1.0e-9;
    int iterations_max = 100;

    void serialize(ParameterArchive& archive);
  };
  [[nodiscard]] static IntegratorNeeds needs(const Parameters& /*parameters*/) noexcept {
    return {.initial_stiffness = true, .corrects_displacement = true, .tries_displacements = true};
  }

  /// @throws ConfigError as require_consistent(); for a parameter out of range; for a step that is not positive; for an
  ///         initial motion that does not fit; when A is singular.
  ImplicitNewmark(const Parameters& parameters, const LinearStructure& structure, double step_s,
                  const InitialMotion& initial = {});

  [[nodiscard]] const MotionState& current() const noexcept override { return current_; }
  [[nodiscard]] const MotionState& completed() const noexcept override { return completed_; }
  [[nodiscard]] int iteration() const noexcept override { return iteration_; }
  [[nodiscard]] bool is_trial() const noexcept override { return is_trial_; }
  [[nodiscard]] double missing_m() const noexcept override { return missing_m_; }
  void advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
               const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept override;
  /// At the first trial of a step.
  void visit_state(const StateVisitor& visit) override;

 private:
  void start() noexcept;
  void predict() noexcept;
  /// By the unbalance.
  void correct() noexcept;
  void judge() noexcept;
  /// Velocity and acceleration of current() that belong to its displacement.
  void follow_displacement() noexcept;

  Parameters parameters_;
  double step_s_;
  FactorisedMatrix mass_factor_;
  FactorisedMatrix tangent_;  // A
  Eigen::SparseMatrix<double> mass_;
  Eigen::SparseMatrix<double> damping_;
  Eigen::VectorXd unbalance_n_;  // f' - r_k, then all of it, then the correction [m]
  Eigen::VectorXd buffer_;
  int iteration_ = 0;
  bool is_trial_ = false;
  bool has_started_ = false;
  double missing_m_ = 0.0;
  MotionState current_;
  MotionState completed_;
};

}  // namespace hybridtest
