#include "diagnosis/scoring/score.hpp"

#include <cmath>

#include "diagnosis/tuning.hpp"

namespace hybridtest {

double held_out_score(const IdentificationProblem& problem, const FitOutcome& outcome) {
  double score = 0.0;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    const double allowed = 1.0 / (fit.weight * fit.weight);
    const double seconds = fit.segment.period_s * static_cast<double>(fit.segment.input.size());
    const double independent = tuning::kIndependentPerSecond * seconds;
    score -= 0.5 * independent * std::log(outcome.segments[i].held_out_mean_square(fit) + allowed);
  }
  return score;
}

GapEnergy gap_energy(const FitSegment& segment, const SegmentResult& result) {
  const double variance = segment.measured.squaredNorm() / static_cast<double>(segment.measured.size());
  if (variance <= 0.0) return {};
  return {.total = result.held_out_mean_square(segment) / variance, .floor = segment.floor * segment.floor / variance};
}

GapEnergy gap_energy(const IdentificationProblem& problem, const FitOutcome& outcome) {
  GapEnergy sum;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    if (!problem.segments[i].is_suspect) continue;
    const GapEnergy one = gap_energy(problem.segments[i], outcome.segments[i]);
    sum.total += one.total;
    sum.floor += one.floor;
  }
  return sum;
}

}  // namespace hybridtest
