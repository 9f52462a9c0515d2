#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>

#include "coordinator/integrators/integrator.hpp"
#include "core/messages.hpp"

namespace hybridtest {

/// How a structure gets into its initial motion, in whole steps.
struct InitialRampSteps {
  Step ramp = 0;  // from rest at zero to the initial motion; not negative
  Step hold = 0;  // then stands there; not negative, 0 with initial velocities
};

/// The way there, as factors of initial displacement and initial velocity.
struct InitialRampPoint {
  std::array<double, 2> displacement{};  // 1 and s
  std::array<double, 2> velocity{};      // 1/s and 1
  std::array<double, 2> acceleration{};  // 1/s2 and 1/s
};

/// At the share x of a ramp of the duration T: the motion
///
///   u = u_0 (10 x^3 - 15 x^4 + 6 x^5) + v_0 T (-4 x^3 + 7 x^4 - 3 x^5),
///
/// which begins at rest at zero and ends in u_0 and v_0, without acceleration at either end.
[[nodiscard]] InitialRampPoint initial_ramp_point(double share, double duration_s) noexcept;

/// A free vibration from given displacements: the structure is pulled there first, then released to the integrator.
///
/// Step k of the ramp of R steps prescribes initial_ramp_point() at k/R, so that actuators are never asked to jump.
/// Forces that are measured on the way change nothing: who pulls the structure takes them. At step R + H the structure
/// is released with u_0 and v_0; from there on the steps are those of the method. completed() holds the prescribed
/// motion until then.
class InitialRamp final : public Integrator {
 public:
  /// @param method   begins with `initial`.
  /// @throws ConfigError as starting_state().
  InitialRamp(std::unique_ptr<Integrator> method, const InitialMotion& initial, double step_s,
              const InitialRampSteps& steps);

  [[nodiscard]] const MotionState& current() const noexcept override;
  [[nodiscard]] const MotionState& completed() const noexcept override;
  // A prescribed displacement is commanded once.
  [[nodiscard]] int iteration() const noexcept override { return is_released() ? method_->iteration() : 0; }
  [[nodiscard]] bool is_trial() const noexcept override { return is_released() && method_->is_trial(); }
  [[nodiscard]] double missing_m() const noexcept override { return is_released() ? method_->missing_m() : 0.0; }
  void advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
               const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept override;
  /// That of the method; what is prescribed follows from the number of steps.
  void visit_state(const StateVisitor& visit) override { method_->visit_state(visit); }

 private:
  [[nodiscard]] bool is_released() const noexcept { return step_ >= steps_.ramp + steps_.hold; }
  void prescribe() noexcept;

  std::unique_ptr<Integrator> method_;
  MotionState initial_;
  double step_s_;
  InitialRampSteps steps_;
  Step step_ = 0;
  bool has_method_completed_ = false;
  MotionState current_;  // prescribed
  MotionState completed_;
};

}  // namespace hybridtest
