#pragma once

#include <Eigen/Core>

#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/identification/linearisation.hpp"
#include "diagnosis/identification/search.hpp"

namespace hybridtest {

/// Fills in the parameters of an outcome whose effects are known, and what is not known of them.
/// @param linear, places, solution   of the fit to all blocks.
void estimate_parameters(const VariableProjection& projection, const IdentificationProblem& problem,
                         const Linearisation& linear, const Eigen::VectorXd& places, const Projected& solution,
                         FitOutcome& outcome);

}  // namespace hybridtest
