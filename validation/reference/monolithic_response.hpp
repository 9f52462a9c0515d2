#pragma once

#include <Eigen/Core>
#include <functional>

#include "scenario/scenario.hpp"

namespace hybridtest {

/// Response of the structure at steps 0, 1, 2 …
struct ReferenceResponse {
  double step_s = 0.0;
  Eigen::MatrixXd displacement_m;  // a row per degree of freedom of the scenario, a column per step
};

/// The whole test in this process: models and the laws of the specimens in place of substructures and sites, Newmark's
/// average acceleration, each step iterated to equilibrium (`implicit_newmark`), with the step of the scenario.
/// @param progress   (steps done, steps in all) now and then; may be empty.
/// @throws ConfigError where OpenSees leads, for a site whose specimen is not known, and for a step without
/// equilibrium.
[[nodiscard]] ReferenceResponse monolithic_response(const Scenario& scenario,
                                                    const std::function<void(Step, Step)>& progress = {});

}  // namespace hybridtest
