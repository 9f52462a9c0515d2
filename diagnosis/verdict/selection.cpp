#include "diagnosis/verdict/selection.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "diagnosis/scoring/random_network.hpp"
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

/// Another effect has to earn its place on data that was not fitted, and to matter.
bool earns_its_place(const IdentificationProblem& problem, const FitOutcome& without, const FitOutcome& with) {
  const double gain = held_out_score(problem, with) - held_out_score(problem, without);
  const double left = gap_energy(problem, with).excess();
  return gain > tuning::kAnotherEffectGain &&
         left < tuning::kAnotherEffectLeaves * gap_energy(problem, without).excess();
}

/// The best pair that one of the leading effects is part of.
FitOutcome best_start(const IdentificationProblem& problem, const IdentificationProblem& coarse, Selection& selection,
                      std::size_t threads) {
  // A random effect is not followed by a fit, and nothing is fitted beside it.
  if (is_random(*selection.library.front().type)) return selection.library.front().fit;
  const FitOutcome first = refit_effects(problem, {selection.library.front().fit.effects.front()}, false);
  FitOutcome best = first;
  double best_score = held_out_score(problem, first);
  const double total = gap_energy(problem, selection.baseline).excess();
  // A best effect that wants a slightly wrong model beside it has a second one coming, however little is left.
  const double enough = selection.library.front().fit.with_nuisance ? tuning::kNothingLeft : tuning::kLittleLeft;
  if (gap_energy(problem, first).excess() < enough * total) return best;
  const std::size_t leaders = std::min(tuning::kLeadersPaired, selection.library.size());
  for (std::size_t i = 0; i < leaders; ++i) {
    std::vector<Candidate> beside = fit_beside(problem, coarse, {selection.library[i].fit.effects.front()}, threads);
    if (!beside.empty() && beside.front().score > best_score && earns_its_place(problem, first, beside.front().fit)) {
      best = beside.front().fit;
      best_score = beside.front().score;
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
  if (std::optional<Candidate> random = fit_random_network(problem, selection.baseline)) {
    selection.library.push_back(std::move(*random));
    std::ranges::stable_sort(selection.library, std::greater{}, &Candidate::score);
  }
  if (selection.library.empty()) return selection;
  selection.probabilities = probabilities_of(selection.library);
  if (selection.library.front().score < held_out_score(problem, selection.baseline) + tuning::kDetectionGain) {
    return selection;
  }
  selection.chosen = best_start(problem, coarse, selection, threads);
  const double total = gap_energy(problem, selection.baseline).excess();
  while (selection.chosen.effects.size() > 1 && selection.chosen.effects.size() < tuning::kMostEffects &&
         gap_energy(problem, selection.chosen).excess() > tuning::kNothingLeft * total) {
    const std::vector<Candidate> beside = fit_beside(problem, coarse, selection.chosen.effects, threads);
    if (beside.empty() || !earns_its_place(problem, selection.chosen, beside.front().fit)) break;
    selection.chosen = beside.front().fit;
  }
  return selection;
}

}  // namespace hybridtest
