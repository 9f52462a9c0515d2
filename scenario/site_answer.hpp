#pragma once

#include "coordinator/preflight/coupled_loop.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// What the control loop of a site answers to one command of size 1: the loop itself is run, with its trajectory,
/// compensators and transfer systems, a linear specimen, and neither noise nor limits. Each command is known when the
/// one before is reached, as in lockstep and as in a paced test whose messages take no longer than a control period.
///
/// A force compensator that is not linear moves the answer in time by ForceDelay::moved_s.
/// @param displacement_m   at which the stiffness of a simulated specimen is looked at.
[[nodiscard]] SiteAnswer site_answer(const Scenario& scenario, const SubstructureScenario& substructure,
                                     LearntDelay learnt, double displacement_m);

/// The same without compensators and with a rig that is neither late nor inexact: the trajectory and the specimen.
[[nodiscard]] SiteAnswer bare_answer(const Scenario& scenario, const SubstructureScenario& substructure,
                                     const Eigen::MatrixXd& stiffness_n_per_m);

/// Standard deviation of what comes out of the compensators of a site for white noise of a standard deviation of 1 at
/// one input, largest over its degrees of freedom. At the start of the test, where they learn.
struct NoiseGains {
  double command_by_target = 1.0;
  double command_by_measured = 0.0;  // displacement
  double force_by_force = 1.0;
};
[[nodiscard]] NoiseGains noise_gains(const Scenario& scenario, const SubstructureScenario& substructure);

/// That of a numerical substructure: the force of the initial stiffness, at once.
[[nodiscard]] SiteAnswer prompt_answer(const Eigen::MatrixXd& stiffness_n_per_m);

}  // namespace hybridtest
