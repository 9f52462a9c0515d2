#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "coordinator/integrators/integrator.hpp"
#include "core/parameters/parameter_archive.hpp"
#include "mechanics/structure/factorised_matrix.hpp"
#include "mechanics/structure/linear_structure.hpp"

namespace hybridtest {

/// Alpha operator splitting (Combescure and Pegon, Soil Dynamics and Earthquake Engineering 16, 1997; with alpha = 0
/// the operator splitting of Nakashima, Kaminosono, Ishida and Ando, 1990). The command is the predictor,
///
///   u~_{i+1} = u_i + dt v_i + dt^2/2 (1 - 2 beta) a_i,   v~_{i+1} = v_i + dt (1 - gamma) a_i,
///
/// and its measured force r~ is carried to the corrected displacement with the initial stiffness K_I:
///
///   u_{i+1} = u~_{i+1} + beta dt^2 a_{i+1},   v_{i+1} = v~_{i+1} + gamma dt a_{i+1},
///   G_{i+1} = f_{i+1} - r~_{i+1} - K_I (u_{i+1} - u~_{i+1}) - C v_{i+1},
///   M a_{i+1} = (1 + alpha) G_{i+1} - alpha G_i,   beta = (1 - alpha)^2/4,   gamma = (1 - 2 alpha)/2.
///
/// The force is taken to be that of the commanded displacement: a tracking error of the actuator is for the
/// compensators of the site to make up for, it is not corrected here.
///
/// Second order in dt. For r = K_I u its roots are those of the HHT-alpha method (Hilber, Hughes and Taylor, 1977),
/// with alpha = 0 those of average acceleration: stable with any step, also where K is less than K_I.
/// Where K exceeds K_I it is stable with alpha = 0 while omega dt of the excess K - K_I is at most 2; with alpha < 0
/// the excess is a negative damping, small while that omega dt is. completed() holds u_i, v_i and the acceleration e_i
/// = M^-1 G_i of equilibrium, which follows from e_{i+1} = (a_{i+1} + alpha e_i)/(1 + alpha). The velocity of current()
/// is v_i + dt a_i.
class AlphaOperatorSplitting final : public Integrator {
 public:
  struct Parameters {
    double alpha = -0.1;

    void serialize(ParameterArchive& archive) {
      archive.optional("alpha", alpha,
                       {{.low = -1.0 / 3.0, .high = 0.0},
                        "0 damps no mode; fast modes keep (1 + alpha)/(1 - alpha) of their motion in a step",
                        "the method loses its stability outside it",
                        "-1/3 to 0"});
    }
  };
  [[nodiscard]] static IntegratorNeeds needs(const Parameters& /*parameters*/) noexcept {
    return {.initial_stiffness = true, .corrects_displacement = true};
  }

  /// @throws ConfigError as require_consistent(); for a parameter out of range; for a step that is not positive; for an
  ///         initial motion that does not fit; when M + (1 + alpha) (gamma dt C + beta dt^2 K_I) is singular.
  AlphaOperatorSplitting(const Parameters& parameters, const LinearStructure& structure, double step_s,
                         const InitialMotion& initial = {});

  [[nodiscard]] const MotionState& current() const noexcept override { return current_; }
  [[nodiscard]] const MotionState& completed() const noexcept override { return completed_; }
  void advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
               const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept override;
  void visit_state(const StateVisitor& visit) override;

 private:
  struct Weights {
    explicit Weights(double alpha) noexcept;
    double alpha;
    double beta;
    double gamma;
  };
  AlphaOperatorSplitting(const Weights& weights, const LinearStructure& structure, double step_s,
                         const InitialMotion& initial);
  void start() noexcept;
  void correct() noexcept;
  void predict() noexcept;

  Weights weights_;
  double step_s_;
  Eigen::SparseMatrix<double> mass_;
  FactorisedMatrix mass_factor_;
  FactorisedMatrix effective_mass_;  // M + (1 + alpha) (gamma dt C + beta dt^2 K_I)
  Eigen::SparseMatrix<double> damping_;
  Eigen::VectorXd predicted_velocity_m_per_s_;  // v~
  Eigen::VectorXd acceleration_;                // a_i of the method
  Eigen::VectorXd right_hand_side_n_;
  bool has_started_ = false;
  MotionState current_;
  MotionState completed_;
};

}  // namespace hybridtest
