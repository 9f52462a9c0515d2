#include "diagnosis/verdict/typical_recording.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace hybridtest {
namespace {

/// The median; the fallback if there are no values.
double median(std::vector<double> values, double fallback) {
  if (values.empty()) return fallback;
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

/// Energy above the floor of each recording: of all its suspect segments, or of those that one effect acts on.
std::map<std::size_t, double> excess_of_recordings(const IdentificationProblem& problem, const FitOutcome& outcome,
                                                   const EffectType* effect = nullptr) {
  std::map<std::size_t, GapEnergy> sums;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    if (!fit.is_suspect || (effect != nullptr && !fit.segment.touched_by(*effect))) continue;
    sums[fit.segment.recording] += gap_energy(fit, outcome.segments[i]);
  }
  std::map<std::size_t, double> excess;
  for (const auto& [recording, sum] : sums) excess[recording] = sum.excess();
  return excess;
}

}  // namespace

Typical typical(const IdentificationProblem& problem, const FitOutcome& by_numbers, const FitOutcome& without,
                const Candidate& further) {
  const FitOutcome& with = further.fit;
  const std::map<std::size_t, double> total = excess_of_recordings(problem, by_numbers, further.type);
  const std::map<std::size_t, double> before = excess_of_recordings(problem, without);
  const std::map<std::size_t, double> left = excess_of_recordings(problem, with);
  std::vector<double> leaves;
  std::vector<double> explains;
  for (const auto& [recording, energy] : total) {
    if (before.at(recording) > 0.0) leaves.push_back(left.at(recording) / before.at(recording));
    if (energy > 0.0) explains.push_back((before.at(recording) - left.at(recording)) / energy);
  }
  return {.leaves = median(std::move(leaves), 1.0), .explains = median(std::move(explains), 0.0)};
}

}  // namespace hybridtest
