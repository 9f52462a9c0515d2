#pragma once

#include "diagnosis/verdict/growth.hpp"
#include "diagnosis/verdict/policy.hpp"
#include "diagnosis/verdict/selection.hpp"

namespace hybridtest {

/// Where the largest cause is less probable than VerdictPolicy::credible in its last comparison: those that may be in
/// its place, as they are beside the other causes, in Selection::alike and first in the library. Its probability is
/// that among these. Nothing for a number of the model.
/// @param growth      how the chosen effects were found.
/// @param selection   with the chosen effects, their shares and their probabilities.
void put_others_beside(const IdentificationProblem& problem, const VerdictPolicy& policy, const Growth& growth,
                       Selection& selection);

}  // namespace hybridtest
