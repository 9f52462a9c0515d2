#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "coordinator/integrators/alpha_weights.hpp"
#include "coordinator/integrators/integrator.hpp"
#include "core/parameters/parameter_archive.hpp"
#include "mechanics/structure/factorised_matrix.hpp"
#include "mechanics/structure/linear_structure.hpp"

namespace hybridtest {

/// KR-alpha (Kolay and Ricles, Earthquake Engineering and Structural Dynamics 43, 2014), and with rho_inf = 1 the
/// method CR (Chen and Ricles, Journal of Engineering Mechanics 134, 2008). Explicit in r; the integration matrices
/// alpha_1 to alpha_3 hold the initial stiffness K_I:
///
///   V_{i+1} = V_i + dt alpha_1 a_i,   u_{i+1} = u_i + dt V_i + (1/2 + gamma) dt^2 alpha_1 a_i,
///   M [(1 - alpha_3) a_{i+1} + alpha_3 a_i] = (1 - alpha_f) g_{i+1} + alpha_f g_i,   g_i = f_i - r_i - C V_i,
///   alpha_1 = A^-1 M,   alpha_3 = A^-1 (alpha_m M + alpha_f P),   A = M + P,   P = gamma dt C + beta dt^2 K_I.
///
/// Weights: AlphaWeights. M^-1 A and M^-1 P commute, so w_i = alpha_1 a_i needs one sparse solve and no dense product:
///
///   [(1 - alpha_m) M + (1 - alpha_f) P] w_{i+1} = (1 - alpha_f) g_{i+1} + alpha_f g_i - [alpha_m M + alpha_f P] w_i.
///
/// V_i is the velocity gamma dt before u_i; current() and completed() give that of u_i itself, V_i + gamma dt w_i.
/// The method starts with V_0 = v_0 - gamma dt w_0: with V_0 = v_0, as published, its error would be of first order
/// whenever the structure starts with an acceleration.
///
/// Second order in dt. For r = K_I u its roots are those of the generalised-alpha method (Chung and Hulbert, 1993),
/// with rho_inf = 1 those of average acceleration: stable with any step, also where K is less than K_I. Where K exceeds
/// K_I it is stable with rho_inf = 1 while omega dt of the excess K - K_I is at most 2; with rho_inf < 1 the excess is
/// a negative damping, small while that omega dt is. completed() is in equilibrium at step i. The velocity and
/// acceleration of current() are those at the end of the parabola that also gives its displacement.
class KrAlpha final : public Integrator {
 public:
  struct Parameters {
    double rho_inf = 0.8;

    void serialize(ParameterArchive& archive) {
      archive.optional(
          "rho_inf", rho_inf,
          {kZeroToOne, "spectral radius of infinitely fast modes: 1 damps none, 0 removes them in a step"});
    }
  };
  [[nodiscard]] static IntegratorNeeds needs(const Parameters& /*parameters*/) noexcept {
    return {.initial_stiffness = true};
  }

  /// @throws ConfigError as require_consistent(); for a parameter out of range; for a step that is not positive; for an
  ///         initial motion that does not fit; when (1 - alpha_m) M + (1 - alpha_f) P is singular.
  KrAlpha(const Parameters& parameters, const LinearStructure& structure, double step_s,
          const InitialMotion& initial = {});

  [[nodiscard]] const MotionState& current() const noexcept override { return current_; }
  [[nodiscard]] const MotionState& completed() const noexcept override { return completed_; }
  void advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
               const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept override;
  void visit_state(const StateVisitor& visit) override;

 private:
  void start() noexcept;
  void take_step() noexcept;

  AlphaWeights weights_;
  double step_s_;
  Eigen::SparseMatrix<double> mass_;
  FactorisedMatrix mass_factor_;
  FactorisedMatrix effective_mass_;         // (1 - alpha_m) M + (1 - alpha_f) P
  Eigen::SparseMatrix<double> old_weight_;  // alpha_m M + alpha_f P
  Eigen::SparseMatrix<double> damping_;
  Eigen::VectorXd start_force_n_;          // gamma dt K_I v_0
  Eigen::VectorXd unbalance_n_;            // f_i - r_i, then g_i
  Eigen::VectorXd memory_n_;               // alpha_f g_i - [alpha_m M + alpha_f P] w_i; zero with rho_inf = 1
  Eigen::VectorXd weighted_;               // w_i
  Eigen::VectorXd late_velocity_m_per_s_;  // V_i
  bool has_started_ = false;
  MotionState current_;
  MotionState completed_;
};

}  // namespace hybridtest
