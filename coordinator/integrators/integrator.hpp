#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <functional>

#include "coordinator/motion_source.hpp"
#include "mechanics/structure/linear_structure.hpp"

namespace hybridtest {

/// What a method needs besides the mass, the damping and the measured forces.
struct IntegratorNeeds {
  /// The initial stiffness, in its matrices: the method is then stable with any step as long as no stiffness exceeds
  /// the initial one. Without it the step is limited by the highest frequency.
  bool initial_stiffness = false;
  /// The displacement is corrected once the force is known: that of completed() is not the one commanded.
  bool corrects_displacement = false;
  /// Commands, each a step of the test apart, in one step of the method.
  int commands_per_step = 1;
  /// Tries displacements before the final one of a step. Only what can go back to the state before the step bears it:
  /// models, not specimens.
  bool tries_displacements = false;
};

using StateVisitor = std::function<void(Eigen::VectorXd& state)>;

/// Time integration of M a + C v + r(u) = f, one restoring force per command.
///
/// At step i the integrator commands a displacement and waits for its force r_i. advance(r_i, f_i)
/// completes step i and moves to step i + 1, unless the command was a trial: then the next command belongs to step i
/// too. Sizes are fixed at construction; advance() allocates nothing.
class Integrator : public MotionSource {
 public:
  /// The step before, with velocity and acceleration in equilibrium, M a + C v + r = f. The
  /// displacement is the one commanded, unless the method corrects it: then r is the measured force
  /// plus the initial stiffness times the correction. Not valid before the first advance().
  [[nodiscard]] const MotionState& completed() const noexcept override = 0;
  /// Visits every vector that current() and later steps depend on, one entry per degree of freedom each, always in the
  /// same order; all are zero at rest. With the same vectors, after as many steps, two integrators go on alike.
  virtual void visit_state(const StateVisitor& visit) = 0;
};

/// Completes the current step: all its trials and its final command, whose force is the last one asked for.
/// @param restoring_force_n   (const MotionState& command) -> one entry per degree of freedom.
template <class Force>
void complete_step(Integrator& integrator, const Force& restoring_force_n,
                   const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) {
  for (bool was_trial = true; was_trial;) {
    was_trial = integrator.is_trial();
    integrator.advance(restoring_force_n(integrator.current()), applied_force_n);
  }
}

/// Initial motion of the structure; an empty vector means zero.
struct InitialMotion {
  Eigen::VectorXd displacement_m;
  Eigen::VectorXd velocity_m_per_s;
};

/// Displacement, velocity and acceleration.
void visit_motion(MotionState& motion, const StateVisitor& visit);

/// The motion at step 0, its acceleration zero until the first restoring force is known.
/// @throws ConfigError when sizes differ from `size` or numbers are not finite.
[[nodiscard]] MotionState starting_state(const InitialMotion& initial, Eigen::Index size);

/// Returns the structure, checked, for use in a member initialiser before the factorisations.
/// @throws ConfigError unless `step_s` is a positive finite number; as require_consistent().
const LinearStructure& require_integrable(const LinearStructure& structure, double step_s);

/// mass M + damping_s C + stiffness_s2 K_I; a term with the weight zero leaves no entries behind.
[[nodiscard]] Eigen::SparseMatrix<double> weighted_sum(const LinearStructure& structure, double mass, double damping_s,
                                                       double stiffness_s2);

}  // namespace hybridtest
