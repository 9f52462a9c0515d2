#pragma once

#include <Eigen/Core>

#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/identification/linearisation.hpp"
#include "diagnosis/identification/search.hpp"

namespace hybridtest {

/// Fills in what a fit leaves of each segment that its effects touch, and of each block when it is not fitted: the fit
/// is moved by Gauss-Newton steps of the other blocks, and the block predicted again in free simulation. This is the
/// fit itself where parameters are linear.
/// @param linear, places, solution   of the fit to all blocks.
void hold_out(const VariableProjection& projection, const IdentificationProblem& problem, const Linearisation& linear,
              const Eigen::VectorXd& places, const Projected& solution, FitOutcome& outcome);

}  // namespace hybridtest
