#pragma once

#include <Eigen/Core>

namespace hybridtest {

/// Motion of the whole structure at one step, one entry per degree of freedom.
struct MotionState {
  Eigen::VectorXd displacement_m;
  Eigen::VectorXd velocity_m_per_s;
  Eigen::VectorXd acceleration_m_per_s2;
};

/// Explicit time integration of M a + C v + r(u) = f, one restoring force per step.
///
/// The integrator stands at step i with u_i known and r_i awaited. advance(r_i, f_i) completes
/// step i and moves to step i + 1. Sizes are fixed at construction; advance() allocates nothing.
class Integrator {
 public:
  virtual ~Integrator() = default;

  /// Step awaiting its restoring force: displacement is final; velocity and acceleration are
  /// predictions. At step 0 the initial state.
  [[nodiscard]] virtual const MotionState& current() const noexcept = 0;
  /// The step before, with velocity and acceleration in equilibrium. Meaningless before the
  /// first advance().
  [[nodiscard]] virtual const MotionState& completed() const noexcept = 0;
  /// @param restoring_force_n, applied_force_n   one entry per degree of freedom, of the current step.
  virtual void advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
                       const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept = 0;
};

}  // namespace hybridtest
