#include "diagnosis/verdict/judgement.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/scoring/score.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

using report::Verdict;

/// Some gap exceeds that multiple of its interface's floor.
bool stands_above_floor(const IdentificationProblem& problem, const Selection& selection, double multiple) {
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    const double gap = selection.baseline.segments[i].mean_square - fit.floor * fit.floor;
    const double floor = fit.segment.floor;
    const double allowance = std::max(0.0, 1.0 / (fit.weight * fit.weight) - fit.floor * fit.floor);
    if (gap > multiple * multiple * floor * floor + allowance) return true;
  }
  return false;
}

Verdict verdict_by_remainder(double left) noexcept {
  if (left <= tuning::kNamedLeaves) return Verdict::named;
  return left <= tuning::kPartialLeaves ? Verdict::partial : Verdict::unknown;
}

/// Most probable first, until together they are probable enough.
std::vector<std::size_t> credible(const Selection& selection) {
  std::vector<std::size_t> members;
  double sum = 0.0;
  for (std::size_t i = 0; i < selection.library.size() && sum < tuning::kCredible; ++i) {
    members.push_back(i);
    sum += selection.probabilities[i];
  }
  return members;
}

}  // namespace

Judgement judge(const IdentificationProblem& problem, const Selection& selection) {
  Judgement judgement;
  if (!stands_above_floor(problem, selection, tuning::kGapOverFloor)) return judgement;
  if (selection.chosen.effects.empty()) {
    if (!stands_above_floor(problem, selection, tuning::kUnknownOverFloor)) return judgement;
    judgement.verdict = Verdict::unknown;
    judgement.gap_left = 1.0;
    return judgement;
  }
  const double total = gap_energy(problem, selection.baseline).excess();
  judgement.gap_left = total > 0.0 ? gap_energy(problem, selection.chosen).excess() / total : 0.0;
  judgement.verdict = verdict_by_remainder(judgement.gap_left);
  const bool is_single = selection.chosen.effects.size() == 1;
  if (judgement.verdict == Verdict::unknown || !is_single) return judgement;
  judgement.indistinguishable = credible(selection);
  if (judgement.verdict == Verdict::named && judgement.indistinguishable.size() > 1) judgement.verdict = Verdict::set;
  return judgement;
}

}  // namespace hybridtest
