#include "diagnosis/verdict/selection.hpp"

#include <algorithm>
#include <cmath>
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
    probabilities.push_back(std::exp(candidate.score - library.front().score));
    sum += probabilities.back();
  }
  for (double& probability : probabilities) probability /= sum;
  return probabilities;
}

/// A number of the user's model that is a little off, as every model's are.
bool is_nuisance(const IdentificationProblem& problem, const EffectType& type) {
  return std::ranges::any_of(problem.segments, [&](const FitSegment& fit) {
    return std::ranges::find(fit.nuisance_types, &type) != fit.nuisance_types.end();
  });
}

/// Of the segments on which the effect acts.
double touched_gap(const IdentificationProblem& problem, const FitOutcome& baseline, const EffectType& effect) {
  double sum = 0.0;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    if (fit.is_suspect && fit.segment.touched_by(effect)) sum += gap_energy(fit, baseline.segments[i]).excess();
  }
  return sum;
}

/// Another effect has to earn its place on data that was not fitted, and to matter: a wrong number for what it
/// leaves, anything else for the whole gap where it acts as well, of which the shape of a right effect is never quite
/// the real one, unless it leaves hardly anything.
bool earns_its_place(const IdentificationProblem& problem, const FitOutcome& baseline, const FitOutcome& without,
                     const Candidate& with) {
  const double gain = held_out_score(problem, with.fit) - held_out_score(problem, without);
  const double before = gap_energy(problem, without).excess();
  const double left = gap_energy(problem, with.fit).excess();
  const double total = touched_gap(problem, baseline, *with.type);
  const bool matters = is_nuisance(problem, *with.type) || before - left > tuning::kAnotherEffectExplains * total ||
                       left < tuning::kSmallEffectLeaves * before;
  return gain > tuning::kAnotherEffectGain && left < tuning::kAnotherEffectLeaves * before && matters;
}

/// Something that a further effect could explain.
bool is_more_left(const GapEnergy& left, double total) {
  constexpr double kVariance = tuning::kSuspectOverFloor * tuning::kSuspectOverFloor;
  return left.excess() > tuning::kNothingLeft * total && left.total > kVariance * left.floor;
}

/// The best of `beside` that earns its place; null when there is none.
const Candidate* first_that_earns(const IdentificationProblem& problem, const FitOutcome& baseline,
                                  const FitOutcome& without, const std::vector<Candidate>& beside) {
  const auto found = std::ranges::find_if(
      beside, [&](const Candidate& candidate) { return earns_its_place(problem, baseline, without, candidate); });
  return found == beside.end() ? nullptr : &*found;
}

/// The best pair that one of the leading effects is part of.
FitOutcome best_start(const IdentificationProblem& problem, const IdentificationProblem& coarse, Selection& selection,
                      std::size_t threads) {
  const FitOutcome first = refit_effects(problem, {selection.library.front().fit.effects.front()}, false);
  FitOutcome best = first;
  double best_score = held_out_score(problem, first);
  const double total = gap_energy(problem, selection.baseline).excess();
  if (!is_more_left(gap_energy(problem, first), total)) return best;
  const std::size_t leaders = std::min(tuning::kLeadersPaired, selection.library.size());
  for (std::size_t i = 0; i < leaders; ++i) {
    std::vector<Candidate> beside = fit_beside(problem, coarse, {selection.library[i].fit.effects.front()}, threads);
    const Candidate* const second = first_that_earns(problem, selection.baseline, first, beside);
    if (second != nullptr && second->score > best_score + static_cast<double>(i > 0) * tuning::kSensorPrior) {
      best = second->fit;
      best_score = second->score;
    }
    if (i == 0) selection.seconds = std::move(beside);
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
