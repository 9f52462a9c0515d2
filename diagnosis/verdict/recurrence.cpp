#include "diagnosis/verdict/recurrence.hpp"

#include <cmath>
#include <cstddef>

#include "diagnosis/identification/discrepancy.hpp"
#include "diagnosis/tuning.hpp"
#include "diagnosis/verdict/where.hpp"
#include "plant/effects/effect_type.hpp"

namespace hybridtest {
namespace {

using report::InterfaceGap;
using report::Verdict;

/// What is left at an interface [mean squares over that of the output, summed over its segments].
struct Left {
  double total = 0.0;
  double by_function = 0.0;
  double segments = 0.0;
};

Left left_at(const IdentificationProblem& problem, const FitOutcome& chosen, const InterfaceGap& gap) {
  Left left;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    const double output = fit.measured.squaredNorm() / static_cast<double>(fit.measured.size());
    if (!fit.is_suspect || name_of(fit.segment.interface) != gap.interface || !(output > 0.0)) continue;
    const ResidualParts parts = fit.discrepancy->parts(left_by(chosen.segments[i], fit));
    left.total += parts.total / output;
    left.by_function += parts.repeatable / output;
    left.segments += 1.0;
  }
  return left;
}

/// As a gap counts beside its floor.
bool follows_motion(const Left& left) {
  return left.by_function > std::pow(tuning::kGapOverFloor, 2) * (left.total - left.by_function);
}

bool repetitions_agree(const Left& left, const InterfaceGap& gap) {
  return gap.repeatability && std::sqrt(left.total / left.segments) > tuning::kNearFloor * gap.repeatability->nrmse;
}

}  // namespace

void add_recurrence(const IdentificationProblem& problem, const FitOutcome& chosen, std::vector<InterfaceGap>& where) {
  for (InterfaceGap& gap : where) {
    if (gap.verdict != Verdict::unknown && gap.verdict != Verdict::partial) continue;
    const Left left = left_at(problem, chosen, gap);
    if (!(left.total > 0.0)) continue;
    report::Recurrence& recurrence = gap.recurrence.emplace();
    recurrence.removed_by_function = left.by_function / left.total;
    recurrence.repetitions_agree = repetitions_agree(left, gap);
    recurrence.follows_motion = follows_motion(left) && (recurrence.repetitions_agree || !was_recorded_again(gap));
  }
}

}  // namespace hybridtest
