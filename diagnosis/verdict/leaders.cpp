#include "diagnosis/verdict/leaders.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "diagnosis/identification/law_candidates.hpp"
#include "diagnosis/tuning.hpp"
#include "diagnosis/verdict/held_out_loss.hpp"
#include "diagnosis/verdict/refutations.hpp"

namespace hybridtest {

void add_numbers(Selection& selection) {
  const FitOutcome& numbers = selection.by_numbers;
  const bool is_there = std::ranges::any_of(
      selection.library, [&](const Candidate& candidate) { return holds(numbers.effects, candidate.type); });
  if (is_there || numbers.effects.empty()) return;
  selection.library.push_back({.type = numbers.effects.front().type,
                               .fit = numbers,
                               .parameters = static_cast<double>(numbers.effects.size())});
}

namespace {

/// A candidate with the wrong numbers of the model that it needs beside it, as effects.
Growth with_its_numbers(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                        const Selection& selection, std::size_t position) {
  const Candidate& candidate = selection.library[position];
  Growth growth{.fit = {}, .accepted = {{candidate.type, candidate.probability}}};
  if (!candidate.fit.with_nuisance) {
    growth.fit = refit_effects(problem, candidate.fit.effects, false);
    return growth;
  }
  std::vector<EffectSetting> start = candidate.fit.effects;
  for (const EffectSetting& number : wrong_numbers(problem, candidate.fit)) {
    if (number.type != candidate.type) start.push_back(number);
  }
  // Of several recordings the numbers differ, and their mean may be far from what fits all: searched everywhere.
  FitOutcome together = refit_effects(problem, search_effects(coarse, start, false).effects, false);
  // The candidate stays: it is what the numbers stand beside.
  for (std::size_t i = start.size(); i-- > candidate.fit.effects.size();) {
    FitOutcome rest = refit_effects(problem, without(together.effects, i), false);
    const Candidate with{.type = together.effects[i].type, .fit = together};
    if (!earns_its_place(problem, selection.by_numbers, rest, with)) together = std::move(rest);
  }
  growth.fit = std::move(together);
  return growth;
}

/// Whether this candidate is grown: the first one is, and one that scores nearly as well; where a sensor's effect
/// leads, also one of a stage that leaves not much more; and the law that leads without its loop, which another effect
/// may make. The same under another name is not.
bool may_lead(const IdentificationProblem& problem, const Selection& selection, std::size_t position) {
  if (position == 0) return true;
  const Candidate& first = selection.library.front();
  const Candidate& candidate = selection.library[position];
  if (are_alike(first.fit, candidate.fit)) return false;
  if (candidate.score > first.score - tuning::kFarBehind) return true;
  if (are_the_same_law(*candidate.type, *first.type)) return true;
  return is_of_sensor(*first.type) && !is_of_sensor(*candidate.type) &&
         tuning::kAnotherEffectLeaves * gap_energy(problem, candidate.fit).excess() <
             gap_energy(problem, first.fit).excess();
}

/// A leading candidate, at its position in the library.
struct Leader {
  std::size_t position = 0;
  Growth growth;
};

/// The numbers of the model that are needed, if nothing is left beside them, or else all: beside another effect others
/// may be needed. At the position of the one that explains most by itself; nothing where they do not explain anything.
std::optional<Leader> leader_of_numbers(const IdentificationProblem& problem, const Selection& selection) {
  const FitOutcome& all = selection.by_numbers;
  const auto first = std::ranges::find_if(
      selection.library, [&](const Candidate& candidate) { return holds(all.effects, candidate.type); });
  if (first == selection.library.end()) return {};
  const std::optional<FitOutcome> needed = needed_numbers(problem, selection);
  if (!needed) return {};
  const auto position = static_cast<std::size_t>(first - selection.library.begin());
  return Leader{position, {gap_energy(problem, *needed).is_clear() ? all : *needed, {{first->type, 1.0}}}};
}

/// Whether numbers of the model would have to take an effect back.
bool is_taken_back(const IdentificationProblem& problem, const FitOutcome& fit, const EffectType& effect) {
  const auto found = std::ranges::find(fit.effects, &effect, &EffectSetting::type);
  return found != fit.effects.end() &&
         is_cancelled(problem, fit, static_cast<std::size_t>(found - fit.effects.begin()));
}

/// The best candidate of the library with the numbers that it needs, if it is no number itself and scores higher.
/// Beside a candidate in the library numbers are free to first order only, and each recording has its own.
std::optional<Leader> decidedly_better(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                                       const Selection& selection, double score) {
  const Candidate& best = selection.library.front();
  if (is_number(problem, *best.type) || !best.fit.with_nuisance) return {};
  Leader leader{0, with_its_numbers(problem, coarse, selection, 0)};
  const FitOutcome& fit = leader.growth.fit;
  if (score_of(problem, fit) <= score || is_taken_back(problem, fit, *best.type)) return {};
  return leader;
}

/// Candidates from which further effects are grown. The numbers of the model come first: they are expected to be off.
/// Where nothing is left beside them, an effect that explains the same has to be decidedly better.
std::vector<Leader> leaders_of(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                               const Selection& selection) {
  std::vector<Leader> leaders;
  const auto is_enough = [&](const Leader& leader) { return !gap_energy(problem, leader.growth.fit).is_clear(); };
  if (std::optional<Leader> numbers = leader_of_numbers(problem, selection)) {
    const double enough = score_of(problem, numbers->growth.fit) + decisive_gain(problem);
    leaders.push_back(std::move(*numbers));
    if (enough > selection.library[0].score && is_enough(leaders.front())) {
      if (std::optional<Leader> better = decidedly_better(problem, coarse, selection, enough)) {
        leaders = {*std::move(better)};
      }
      return leaders;
    }
  }
  const std::size_t count = std::min(tuning::kLeadersPaired, selection.library.size());
  for (std::size_t i = 0; i < count; ++i) {
    if (!may_lead(problem, selection, i) || (!leaders.empty() && leaders.front().position == i)) continue;
    Growth leader = with_its_numbers(problem, coarse, selection, i);
    if (!leaders.empty() && is_taken_back(problem, leader.fit, *selection.library[i].type)) continue;
    leaders.push_back({i, std::move(leader)});
    if (i == 0 && is_enough(leaders.back())) break;
  }
  return leaders;
}

/// Where what a leader found stands in the library: an effect that was found beside numbers of the model is that effect
/// with its numbers, and is put first.
std::size_t place_of_found(const Selection& selection, Leader& leader) {
  std::vector<Accepted>& accepted = leader.growth.accepted;
  const auto is_of_numbers = [&](const Accepted& one) { return holds(selection.by_numbers.effects, one.type); };
  if (accepted.size() < 2 || !is_of_numbers(accepted.front()) || is_of_numbers(accepted.back())) return leader.position;
  const auto found = std::ranges::find(selection.library, accepted.back().type, &Candidate::type);
  if (found == selection.library.end()) return leader.position;
  std::swap(accepted.front(), accepted.back());
  return static_cast<std::size_t>(found - selection.library.begin());
}

/// The leading candidates, each with the further effect that it needs most; by their positions in the library.
std::map<std::size_t, Growth> grow_leaders(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                                           const Selection& selection, const PartProgress& progress) {
  std::map<std::size_t, Growth> grown_leaders;
  std::vector<Leader> leaders = leaders_of(problem, coarse, selection);
  for (std::size_t i = 0; i < leaders.size(); ++i) {
    Growth& leader = leaders[i].growth;
    if (gap_energy(problem, leader.fit).is_clear()) {
      const std::vector<Candidate> beside =
          fit_beside(problem, coarse, leader.fit.effects, Beside::as_found, progress.round(i, leaders.size()));
      if (std::optional<Growth> pair = grown(problem, selection.by_numbers, leader, beside)) leader = std::move(*pair);
    }
    const std::size_t position = place_of_found(selection, leaders[i]);
    const auto [place, is_new] = grown_leaders.try_emplace(position, leader);
    if (!is_new && score_of(problem, leader.fit) > score_of(problem, place->second.fit)) place->second = leader;
  }
  return grown_leaders;
}

/// Between effects that the recordings cannot tell apart, the score decides nothing.
void share_evenly(const std::vector<AlikeLeader>& alike, std::vector<Candidate>& library) {
  const auto probability_of = [&](const AlikeLeader& leader) -> double& {
    return std::ranges::find(library, leader.type, &Candidate::type)->probability;
  };
  double sum = 0.0;
  for (const AlikeLeader& leader : alike) sum += probability_of(leader);
  for (const AlikeLeader& leader : alike) probability_of(leader) = sum / static_cast<double>(alike.size());
}

void put_most_probable_first(std::vector<Candidate>& library) {
  std::ranges::stable_sort(library, std::greater{}, &Candidate::probability);
}

/// Numbers of the model that lead alone are preferred to what has to be decidedly better than they are: that is their
/// probability, too.
void weigh_numbers(const IdentificationProblem& problem, std::size_t position, Growth& growth, Selection& selection) {
  if (!holds(selection.by_numbers.effects, selection.library[position].type)) return;
  std::vector<double> scores = scores_of(selection.library);
  scores[position] = std::max(scores[position], score_of(problem, growth.fit) + decisive_gain(problem));
  weigh(selection.library, std::move(scores));
  selection.library[position].held_out = held_out_score(problem, growth.fit);
  growth.accepted.front().probability = selection.library[position].probability;
  put_most_probable_first(selection.library);
}

/// Numbers of the model and the zero of a sensor, which may hide that they are off; the zero with which they predict
/// best.
FitOutcome with_a_zero(const IdentificationProblem& problem, const FitOutcome& numbers) {
  FitOutcome best = numbers;
  for (const EffectSetting& zero : zeros_of(problem)) {
    std::vector<EffectSetting> effects = numbers.effects;
    effects.push_back(zero);
    FitOutcome fit = refit_effects(problem, effects, false);
    if (held_out_score(problem, fit) > held_out_score(problem, best)) best = std::move(fit);
  }
  return best;
}

}  // namespace

std::optional<FitOutcome> needed_numbers(const IdentificationProblem& problem, const Selection& selection) {
  const FitOutcome& all = selection.by_numbers;
  if (all.effects.empty()) return {};
  const auto tells = [&](const FitOutcome& fit) {
    return held_out_score(problem, fit) > held_out_score(problem, selection.baseline) + decisive_gain(problem);
  };
  // What leads and is a number or a zero itself has the others found beside it.
  const bool is_led_by_number = is_number(problem, *selection.library.front().type);
  FitOutcome needed = tells(all) || is_led_by_number ? all : with_a_zero(problem, all);
  if (!tells(needed)) return {};
  prune(problem, all, needed);
  return needed;
}

Growth best_start(const IdentificationProblem& problem, const IdentificationProblem& coarse, Selection& selection,
                  const PartProgress& progress) {
  std::map<std::size_t, Growth> leaders = grow_leaders(problem, coarse, selection, progress);
  if (leaders.size() == 1) {
    auto& [position, growth] = *leaders.begin();
    weigh_numbers(problem, position, growth, selection);
    return std::move(growth);
  }
  const auto by_score = [&](const auto& leader) { return score_of(problem, leader.second.fit); };
  auto best = std::ranges::max_element(leaders, {}, by_score);
  const auto highest = best;
  const auto is_told = [&](const auto& leader) {
    return loss_by(problem, leader.second.fit, highest->second.fit).is_certain();
  };
  // Of those that may predict as well, the simplest.
  for (auto leader = leaders.begin(); leader != leaders.end(); ++leader) {
    const bool is_simpler = leader->second.fit.effects.size() < best->second.fit.effects.size();
    if (is_simpler && !is_told(*leader)) best = leader;
  }
  const auto is_alike = [&](const auto& leader) {
    return are_alike(best->second.fit, leader.second.fit) || !is_told(leader);
  };
  if (is_of_sensor(*selection.library[best->first].type)) {
    const auto of_stage = std::ranges::find_if(leaders, [&](const auto& leader) {
      return !is_of_sensor(*selection.library[leader.first].type) && is_alike(leader);
    });
    if (of_stage != leaders.end()) best = of_stage;
  }
  std::vector<double> scores = scores_of(selection.library);
  for (const auto& leader : leaders) {
    // What stands beside the best, or beside which the best stands, is not in its place, and does not count against it;
    // nor does what was dropped from what was found with it, nor the same law with or without a loop of its own.
    const EffectType* const type = selection.library[leader.first].type;
    const bool is_there = holds(leader.second.fit.effects, type);
    const bool is_instead = is_there && !holds(best->second.fit.effects, type) &&
                            !holds(leader.second.fit.effects, selection.library[best->first].type) &&
                            !are_the_same_law(*type, *selection.library[best->first].type);
    if (leader.first != best->first && !is_instead) {
      scores[leader.first] = -std::numeric_limits<double>::infinity();
      continue;
    }
    // By itself it had numbers of its own in each recording; these are the same in all.
    scores[leader.first] = by_score(leader);
    selection.library[leader.first].held_out = held_out_score(problem, leader.second.fit);
    if (is_there && is_alike(leader)) selection.alike.push_back({type, leader.second.fit});
  }
  weigh(selection.library, std::move(scores));
  share_evenly(selection.alike, selection.library);
  best->second.accepted.front().probability = selection.library[best->first].probability;
  put_most_probable_first(selection.library);
  return std::move(best->second);
}

}  // namespace hybridtest
