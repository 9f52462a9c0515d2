#pragma once

#include <vector>

#include "diagnosis/result/diagnosis_report.hpp"
#include "diagnosis/verdict/selection.hpp"

namespace hybridtest {

/// What may be said of a gap.
struct Judgement {
  report::Verdict verdict = report::Verdict::none;
  // Positions in Selection::library of what cannot be told from the first cause; it is one of them.
  std::vector<std::size_t> indistinguishable;
  double gap_left = 0.0;  // share of the repeatable gap that the chosen effects leave
};

[[nodiscard]] Judgement judge(const IdentificationProblem& problem, const Selection& selection);

}  // namespace hybridtest
