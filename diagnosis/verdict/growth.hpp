#pragma once

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "diagnosis/verdict/selection.hpp"

namespace hybridtest {

/// Another effect in the place of one that was accepted, and what stands beside it.
struct Instead {
  const EffectType* type = nullptr;
  double probability = 0.0;
  FitOutcome fit;
};

/// An effect and its probability against the others that were tried in its place; and these, where all of them stood
/// beside the same others.
struct Accepted {
  const EffectType* type = nullptr;
  double probability = 1.0;
  std::vector<Instead> others{};
};

/// Effects accepted so far, fitted together.
struct Growth {
  FitOutcome fit;
  std::vector<Accepted> accepted;

  /// What was known of its probability before is forgotten.
  void accept(Accepted one) {
    std::erase_if(accepted, [&](const Accepted& other) { return other.type == one.type; });
    accepted.push_back(std::move(one));
  }
  [[nodiscard]] double probability_of(const EffectType* type) const {
    const auto found = std::ranges::find(accepted, type, &Accepted::type);
    return found == accepted.end() ? 1.0 : found->probability;
  }
};

/// Softmax of the scores.
[[nodiscard]] std::vector<double> softmax(std::vector<double> scores);

[[nodiscard]] std::vector<double> scores_of(const std::vector<Candidate>& candidates);

/// Gives each candidate its probability: the softmax of these scores, one for each.
void weigh(std::vector<Candidate>& candidates, std::vector<double> scores);

/// The score of a fit on held-out blocks, and what its parameters cost [nats].
[[nodiscard]] double score_of(const IdentificationProblem& problem, const FitOutcome& fit);

[[nodiscard]] bool holds(const std::vector<EffectSetting>& effects, const EffectType* type);

/// Effects without one of them.
[[nodiscard]] std::vector<EffectSetting> without(const std::vector<EffectSetting>& effects, std::size_t position);

/// The effect's change of what it acts on is small, in every suspect segment [rms over rms].
[[nodiscard]] bool changes_at_most(const IdentificationProblem& problem, const EffectSetting& effect, double share);

/// A further effect is accepted only if it improves the score on held-out blocks and explains enough. Wrong numbers of
/// the model are expected: the score alone decides. Any other effect is also judged by the gap that it leaves and by
/// the whole gap where it acts that numbers do not explain, unless it leaves hardly anything: even the right effect
/// never has exactly the shape of the real one, but a number has.
[[nodiscard]] bool earns_its_place(const IdentificationProblem& problem, const FitOutcome& by_numbers,
                                   const FitOutcome& without, const Candidate& with);

/// The numbers of the model that may be off, and damping, as effects that change nothing yet. Not among them: zeros,
/// which are known exactly before a test, effects that the model has, and the hardening.
[[nodiscard]] std::vector<EffectSetting> numbers_of(const IdentificationProblem& problem);

/// The zeros of sensors that are judged, each as an effect that changes nothing yet.
[[nodiscard]] std::vector<EffectSetting> zeros_of(const IdentificationProblem& problem);

/// Drops what the other effects can do without, the least needed first, and what is needless.
void prune(const IdentificationProblem& problem, const FitOutcome& by_numbers, FitOutcome& fit);

/// With the round's best, if it is accepted.
[[nodiscard]] std::optional<Growth> grown(const IdentificationProblem& problem, const FitOutcome& by_numbers,
                                          const Growth& from, const std::vector<Candidate>& beside);

/// Further effects one by one, until none is accepted: first beside what was found as it is, where that finds nothing
/// with the numbers of the model free, which a further effect may move, and at last with what was found giving way.
/// @param freedom   how the first one is looked for.
void grow_further(const IdentificationProblem& problem, const IdentificationProblem& coarse, const Selection& selection,
                  Beside freedom, const PartProgress& progress, Growth& growth);

/// Where what was found leaves little above the floor: numbers of the model that are slightly off. Beside a large cause
/// they are nothing that a further effect is looked for, but another motion may show more of them.
/// @param within   of the output that each of them may change [rms over rms].
void correct_numbers(const IdentificationProblem& problem, const FitOutcome& by_numbers, double within, Growth& growth);

/// Which effects are needed, when all are known: compared at the lower rate, at a fraction of the cost. What is lost so
/// at the full rate is asked there: what moves within a few samples, as a slip, hardly exists at the lower one.
/// @return whether an effect was dropped.
bool settle(const IdentificationProblem& problem, const IdentificationProblem& coarse, const Selection& selection,
            Growth& growth);

}  // namespace hybridtest
