#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "coordinator/integrators/alpha_weights.hpp"
#include "coordinator/integrators/integrator.hpp"
#include "core/parameters/parameter_archive.hpp"
#include "mechanics/structure/factorised_matrix.hpp"
#include "mechanics/structure/linear_structure.hpp"

namespace hybridtest {

/// Generalised-alpha (Chung and Hulbert, Journal of Applied Mechanics 60, 1993) with a fixed number of iterations for
/// displacement control, after Schellenberg, Mahin and Fenves (PEER report 2009/104). A step h holds n commands, each a
/// step of the test apart: h = n dt. With Newmark's formulas for u' and v' at its end, equilibrium is
///
///   M [(1 - alpha_m) a' + alpha_m a] = (1 - alpha_f) G' + alpha_f G,   G' = f' - r' - C v',   r' = r_j + K_I (u' -
///   c_j),
///
/// with the force r_j measured at the newest command c_j and the newest load: one sparse solve, with
/// (1 - alpha_m) M + (1 - alpha_f) (gamma h C + beta h^2 K_I). Command j + 1 lies at (j + 1)/n on the parabola through
/// the two steps before and the u' so found, so that the specimen moves steadily and reaches u' with the last command;
/// that one's force corrects the step for the last time. Weights: AlphaWeights.
///
/// Second order in dt. For r = K_I u its roots are those of the method of Chung and Hulbert with h: stable with any
/// step, also where K is less than K_I. completed() is in equilibrium: at a command inside the step with the motion of
/// the parabola, at the end of the step with that of the method.
class GeneralisedAlpha final : public Integrator {
 public:
  struct Parameters {
    double rho_inf = 0.8;
    int iterations = 3;

    void serialize(ParameterArchive& archive) {
      archive.optional(
          "rho_inf", rho_inf,
          {kZeroToOne, "spectral radius of infinitely fast modes: 1 damps none, 0 removes them in a step"});
      archive.optional("iterations", iterations,
                       {{.low = 2.0, .high = 20.0}, "commands in one step of the method, which is as many steps long"});
    }
  };
  [[nodiscard]] static IntegratorNeeds needs(const Parameters& parameters) noexcept {
    return {.initial_stiffness = true, .corrects_displacement = true, .commands_per_step = parameters.iterations};
  }

  /// @param step_s   between commands.
  /// @throws ConfigError as require_consistent(); for a parameter out of range; for a step that is not positive; for an
  ///         initial motion that does not fit; when the matrix of the solve is singular.
  GeneralisedAlpha(const Parameters& parameters, const LinearStructure& structure, double step_s,
                   const InitialMotion& initial = {});

  [[nodiscard]] const MotionState& current() const noexcept override { return current_; }
  [[nodiscard]] const MotionState& completed() const noexcept override { return completed_; }
  void advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
               const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept override;
  void visit_state(const StateVisitor& visit) override;

 private:
  void start() noexcept;
  void complete() noexcept;
  void predict_end() noexcept;
  void find_end() noexcept;
  void end_step() noexcept;
  void place_command() noexcept;

  AlphaWeights weights_;
  int iterations_;
  double step_s_;  // h
  FactorisedMatrix mass_factor_;
  FactorisedMatrix effective_mass_;  // (1 - alpha_m) M + (1 - alpha_f) (gamma h C + beta h^2 K_I)
  Eigen::SparseMatrix<double> mass_;
  Eigen::SparseMatrix<double> damping_;
  Eigen::SparseMatrix<double> stiffness_;
  int iteration_ = 0;                         // of the command that waits for its force, 1 to n; at the start 0
  MotionState begin_;                         // u, v and a
  MotionState end_;                           // u', v' and a' by the newest force
  Eigen::VectorXd balanced_;                  // M^-1 G at the beginning
  Eigen::VectorXd displacement_before_m_;     // a step before u
  Eigen::VectorXd predicted_displacement_m_;  // u' and v' with a' = 0
  Eigen::VectorXd predicted_velocity_m_per_s_;
  Eigen::VectorXd constant_n_;   // of the equation for a', the same at each command of a step
  Eigen::VectorXd unbalance_n_;  // f - r of the newest command
  Eigen::VectorXd buffer_;
  MotionState current_;
  MotionState completed_;
};

}  // namespace hybridtest
