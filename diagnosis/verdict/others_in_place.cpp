#include "diagnosis/verdict/others_in_place.hpp"

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "diagnosis/identification/law_candidates.hpp"
#include "diagnosis/verdict/library_fits.hpp"

namespace hybridtest {
namespace {

/// What may be in the place of a cause beside the others, with its probability; the most probable first, until they are
/// credible together with the cause, which is last. Not among them: numbers of the model, which the cause was preferred
/// to, and the same law with a loop or without.
std::vector<Instead> in_its_place(const IdentificationProblem& problem, const Selection& selection,
                                  const Accepted& cause, double credible) {
  std::vector<Instead> others;
  double all = cause.probability;
  for (const Instead& other : cause.others) {
    const auto listed = std::ranges::find(selection.library, other.type, &Candidate::type);
    const bool is_beside = holds(selection.chosen.effects, other.type);
    if (listed == selection.library.end() || is_number(problem, *other.type) || is_beside) continue;
    if (are_the_same_law(*other.type, *cause.type)) continue;
    // With numbers of the model and without, it is one.
    const auto before = std::ranges::find(others, other.type, &Instead::type);
    if (before == others.end()) {
      others.push_back(other);
    } else if (other.probability > before->probability) {
      all -= before->probability;
      *before = other;
    } else {
      continue;
    }
    all += other.probability;
  }
  std::ranges::stable_sort(others, std::greater{}, &Instead::probability);
  double sum = cause.probability / all;
  std::size_t count = 0;
  while (count < others.size() && sum < credible) sum += others[count++].probability / all;
  others.resize(count);
  others.push_back({cause.type, cause.probability, selection.chosen});
  for (Instead& one : others) one.probability /= all;
  return others;
}

}  // namespace

void put_others_beside(const IdentificationProblem& problem, const VerdictPolicy& policy, const Growth& growth,
                       Selection& selection) {
  const auto largest = static_cast<std::size_t>(std::ranges::max_element(selection.shares) - selection.shares.begin());
  const EffectType* const type = selection.chosen.effects[largest].type;
  const auto cause = std::ranges::find(growth.accepted, type, &Accepted::type);
  if (is_number(problem, *type) || cause == growth.accepted.end()) return;
  std::vector<Instead> members = in_its_place(problem, selection, *cause, policy.credible);
  selection.chosen_probabilities[largest] = members.back().probability;
  if (members.size() == 1) {
    // A leader that was told from no other one shares its probability with that.
    const bool is_alike = std::ranges::find(selection.alike, type, &AlikeLeader::type) != selection.alike.end();
    const auto listed = std::ranges::find(selection.library, type, &Candidate::type);
    if (is_alike && selection.alike.size() > 1) selection.chosen_probabilities[largest] = listed->probability;
    return;
  }
  selection.alike.clear();
  for (Candidate& candidate : selection.library) candidate.probability = 0.0;
  for (Instead& member : members) {
    Candidate& candidate = *std::ranges::find(selection.library, member.type, &Candidate::type);
    candidate.probability = member.probability;
    candidate.held_out = held_out_score(problem, member.fit);
    selection.alike.push_back({member.type, std::move(member.fit)});
  }
  std::ranges::stable_sort(selection.library, std::greater{}, &Candidate::probability);
}

}  // namespace hybridtest
