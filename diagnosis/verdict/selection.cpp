#include "diagnosis/verdict/selection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "diagnosis/scoring/score.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

/// Softmax of the scores.
std::vector<double> probabilities_of(const std::vector<Candidate>& library) {
  std::vector<double> probabilities;
  double sum = 0.0;
  for (const Candidate& candidate : library) {
    probabilities.push_back(std::exp((candidate.score - library.front().score) / tuning::kTemperature));
    sum += probabilities.back();
  }
  for (double& probability : probabilities) probability /= sum;
  return probabilities;
}

/// The middle one, or the mean of the two in the middle; of none the fallback.
double median(std::vector<double> values, double fallback) {
  if (values.empty()) return fallback;
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

/// Excess energy of each recording, all its suspect segments together, or those that one effect acts on.
std::map<std::size_t, double> excess_of_recordings(const IdentificationProblem& problem, const FitOutcome& outcome,
                                                   const EffectType* effect = nullptr) {
  std::map<std::size_t, GapEnergy> sums;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    if (!fit.is_suspect || (effect != nullptr && !fit.segment.touched_by(*effect))) continue;
    const GapEnergy one = gap_energy(fit, outcome.segments[i]);
    GapEnergy& sum = sums[problem.segments[i].segment.recording];
    sum.total += one.total;
    sum.floor += one.floor;
  }
  std::map<std::size_t, double> excess;
  for (const auto& [recording, sum] : sums) excess[recording] = sum.excess();
  return excess;
}

/// What a further effect does to a typical recording: a single odd one, of which no effect explains much, does
/// not decide.
struct Typical {
  double leaves = 1.0;    // of what was left
  double explains = 0.0;  // of the whole gap where it acts
};

Typical typical(const IdentificationProblem& problem, const FitOutcome& baseline, const FitOutcome& without,
                const Candidate& further) {
  const FitOutcome& with = further.fit;
  const std::map<std::size_t, double> total = excess_of_recordings(problem, baseline, further.type);
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

/// Another effect has to earn its place on data that was not fitted, and to matter: a wrong number for what it
/// leaves, anything else for the whole gap where it acts as well, of which the shape of a right effect is never quite
/// the real one, unless it leaves hardly anything.
bool earns_its_place(const IdentificationProblem& problem, const FitOutcome& baseline, const FitOutcome& without,
                     const Candidate& with) {
  const double gain = held_out_score(problem, with.fit) - held_out_score(problem, without);
  const Typical change = typical(problem, baseline, without, with);
  const bool matters = is_model_number(problem, *with.type) || change.explains > tuning::kAnotherEffectExplains ||
                       change.leaves < tuning::kSmallEffectLeaves;
  return gain > tuning::kAnotherEffectGain && change.leaves < tuning::kAnotherEffectLeaves && matters;
}

/// Something that a further effect could explain.
bool is_more_left(const GapEnergy& left, double total) {
  constexpr double kVariance = tuning::kSuspectOverFloor * tuning::kSuspectOverFloor;
  return left.excess() > tuning::kNothingLeft * total && left.total > kVariance * left.floor;
}

/// The best of `beside` that earns its place; null when there is none.
/// A wrong number of the model that explains nearly as much goes first, so that it is not called a missing effect.
const Candidate* first_that_earns(const IdentificationProblem& problem, const FitOutcome& baseline,
                                  const FitOutcome& without, const std::vector<Candidate>& beside) {
  const auto earns = [&](const Candidate& candidate) { return earns_its_place(problem, baseline, without, candidate); };
  const auto best = std::ranges::find_if(beside, earns);
  if (best == beside.end()) return nullptr;
  const double before = gap_energy(problem, without).excess();
  const double enough = tuning::kNumberInstead * (before - gap_energy(problem, best->fit).excess());
  const auto number = std::ranges::find_if(beside, [&](const Candidate& candidate) {
    return is_model_number(problem, *candidate.type) && before - gap_energy(problem, candidate.fit).excess() > enough &&
           earns(candidate);
  });
  return number == beside.end() ? &*best : &*number;
}

/// The best pair that one of the leading effects is part of.
FitOutcome best_start(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                      const Selection& selection, std::size_t threads) {
  const FitOutcome first = refit_effects(problem, {selection.library.front().fit.effects.front()}, false);
  FitOutcome best = first;
  double best_score = -std::numeric_limits<double>::infinity();
  const double total = gap_energy(problem, selection.baseline).excess();
  if (!is_more_left(gap_energy(problem, first), total)) return best;
  const std::size_t leaders = std::min(tuning::kLeadersPaired, selection.library.size());
  for (std::size_t i = 0; i < leaders; ++i) {
    if (selection.library[i].score < selection.library.front().score - tuning::kFarBehind) break;
    const std::vector<Candidate> beside =
        fit_beside(problem, coarse, {selection.library[i].fit.effects.front()}, threads);
    const Candidate* const second = first_that_earns(problem, selection.baseline, first, beside);
    if (second != nullptr && second->score > best_score) {
      best = second->fit;
      best_score = second->score;
    }
  }
  return best;
}

}  // namespace

Selection select_effects(const IdentificationProblem& problem, const IdentificationProblem& coarse, std::size_t threads,
                         const FitProgress& progress) {
  Selection selection;
  selection.baseline = fit_nothing(problem, false);
  selection.chosen = selection.baseline;
  selection.library = fit_library(problem, coarse, threads, progress);
  if (selection.library.empty()) return selection;
  selection.probabilities = probabilities_of(selection.library);
  if (selection.library.front().score < held_out_score(problem, selection.baseline) + tuning::kDetectionGain) {
    return selection;
  }
  selection.chosen = best_start(problem, coarse, selection, threads);
  const double total = gap_energy(problem, selection.baseline).excess();
  while (selection.chosen.effects.size() > 1 && selection.chosen.effects.size() < tuning::kMostEffects &&
         is_more_left(gap_energy(problem, selection.chosen), total)) {
    const std::vector<Candidate> beside = fit_beside(problem, coarse, selection.chosen.effects, threads);
    const Candidate* const next = first_that_earns(problem, selection.baseline, selection.chosen, beside);
    if (next == nullptr) break;
    selection.chosen = next->fit;
  }
  return selection;
}

}  // namespace hybridtest
