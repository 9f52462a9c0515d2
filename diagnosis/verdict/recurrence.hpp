#pragma once

#include <vector>

#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/identification/problem.hpp"
#include "diagnosis/result/diagnosis_report.hpp"

namespace hybridtest {

/// Whether what the causes leave at each interface comes back when the motion does, where the verdict on it is
/// `unknown` or `partial`. A function of the motion predicts it in cycles to which it was not fitted (Discrepancy), by
/// so much that it would be a gap; or it is well above the difference between repetitions. Where recordings repeat each
/// other, they decide: what follows the motion in each, and differs, does not repeat.
/// @param chosen   fit of the causes in the same problem.
/// @param where    with its verdicts, and the differences between repetitions where there are any.
void add_recurrence(const IdentificationProblem& problem, const FitOutcome& chosen,
                    std::vector<report::InterfaceGap>& where);

}  // namespace hybridtest
