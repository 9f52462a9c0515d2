#include "diagnosis/verdict/selection.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <typeinfo>

#include "diagnosis/identification/search.hpp"
#include "diagnosis/tuning.hpp"
#include "diagnosis/verdict/refutations.hpp"

namespace hybridtest {

namespace {

/// Softmax of the scores.
std::vector<double> softmax(std::vector<double> scores) {
  if (scores.empty()) return scores;
  const double best = *std::ranges::max_element(scores);
  double sum = 0.0;
  for (double& score : scores) {
    score = std::exp((score - best) / tuning::kTemperature);
    sum += score;
  }
  for (double& probability : scores) probability /= sum;
  return scores;
}

std::vector<double> scores_of(const std::vector<Candidate>& candidates) {
  std::vector<double> scores;
  std::ranges::transform(candidates, std::back_inserter(scores), &Candidate::score);
  return scores;
}

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

/// What a further effect changes in a typical (median) recording, so that a single unusual recording does not
/// decide.
struct Typical {
  double leaves = 1.0;    // share of the gap that remained before it
  double explains = 0.0;  // of the whole gap where it acts
};

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

/// A number of the model, or the damping that every model leaves out.
bool is_number(const IdentificationProblem& problem, const EffectType& type) {
  return is_model_number(problem, type) || type.traits.number == ModelNumber::damping;
}

/// A further effect is accepted only if it improves the score on held-out blocks and explains enough. Wrong numbers of
/// the model are expected: the score alone decides. Any other effect is also judged by the gap that it leaves and by
/// the whole gap where it acts that numbers do not explain, unless it leaves hardly anything: even the right effect
/// never has exactly the shape of the real one, but a number has.
bool earns_its_place(const IdentificationProblem& problem, const FitOutcome& by_numbers, const FitOutcome& without,
                     const Candidate& with) {
  const double gain = held_out_score(problem, with.fit) - held_out_score(problem, without);
  if (gain <= decisive_gain(problem)) return false;
  if (is_number(problem, *with.type)) return true;
  const Typical change = typical(problem, by_numbers, without, with);
  const bool matters = change.explains > tuning::kAnotherEffectExplains || change.leaves < tuning::kSmallEffectLeaves;
  return change.leaves < tuning::kAnotherEffectLeaves && matters;
}

/// The numbers of the model that may be off, and damping, as effects that change nothing yet. Not among them: zeros,
/// which are known exactly before a test, and effects that the model has.
std::vector<EffectSetting> numbers_of(const IdentificationProblem& problem) {
  std::vector<EffectSetting> numbers;
  for (const EffectType* const type : judged_effects(problem)) {
    if (!is_number(problem, *type) || type->traits.number == ModelNumber::offset) continue;
    if (place_of(problem.model, *type) == nullptr) numbers.push_back(absent(*type));
  }
  return numbers;
}

/// The model with its numbers free, and damping: what is left is for other effects.
FitOutcome fit_numbers(const IdentificationProblem& problem, const IdentificationProblem& coarse) {
  return refit_effects(problem, search_effects(coarse, numbers_of(coarse), false).effects, false);
}

/// The best of `beside` that is accepted; null when there is none.
/// A wrong number of the model that explains nearly as much is preferred, so that it is not called a missing effect.
const Candidate* first_that_earns(const IdentificationProblem& problem, const FitOutcome& by_numbers,
                                  const FitOutcome& without, const std::vector<Candidate>& beside) {
  const auto earns = [&](const Candidate& candidate) {
    return earns_its_place(problem, by_numbers, without, candidate);
  };
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

/// An effect and its probability against the others that were tried in its place.
struct Accepted {
  const EffectType* type = nullptr;
  double probability = 1.0;
};

double score_of(const IdentificationProblem& problem, const FitOutcome& fit) {
  return held_out_score(problem, fit) + prior(problem, fit);
}

bool holds(const std::vector<EffectSetting>& effects, const EffectType* type) {
  return std::ranges::find(effects, type, &EffectSetting::type) != effects.end();
}

/// Effects accepted so far, fitted together.
struct Growth {
  FitOutcome fit;
  std::vector<Accepted> accepted;

  [[nodiscard]] double probability_of(const EffectType* type) const {
    const auto found = std::ranges::find(accepted, type, &Accepted::type);
    return found == accepted.end() ? 1.0 : found->probability;
  }
};

/// Effects without one of them.
std::vector<EffectSetting> without(const std::vector<EffectSetting>& effects, std::size_t position) {
  std::vector<EffectSetting> rest = effects;
  rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(position));
  return rest;
}

/// Drops what the other effects can do without, the least needed first, and what is needless.
void prune(const IdentificationProblem& problem, const FitOutcome& by_numbers, FitOutcome& fit) {
  while (fit.effects.size() > 1) {
    std::optional<FitOutcome> best;
    for (std::size_t i = 0; i < fit.effects.size(); ++i) {
      FitOutcome rest = refit_effects(problem, without(fit.effects, i), false);
      const EffectType& type = *fit.effects[i].type;
      if (!is_needless(problem, fit, i) && earns_its_place(problem, by_numbers, rest, {.type = &type, .fit = fit}))
        continue;
      if (!best || held_out_score(problem, rest) > held_out_score(problem, *best)) best = std::move(rest);
    }
    if (!best) return;
    fit = std::move(*best);
  }
}

/// A candidate with the wrong numbers of the model that it needs beside it, as effects.
Growth with_its_numbers(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                        const Selection& selection, std::size_t position) {
  const Candidate& candidate = selection.library[position];
  Growth growth{.fit = {}, .accepted = {{candidate.type, selection.probabilities[position]}}};
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

/// A candidate in the place of one effect, and what was found beside that one; by itself, and with the numbers of the
/// model that it needed. The numbers of a law that another law replaces go with it. None where the candidate is found
/// already.
std::vector<std::vector<EffectSetting>> with_instead(const IdentificationProblem& problem,
                                                     const std::vector<EffectSetting>& effects, std::size_t position,
                                                     const Candidate& candidate) {
  const auto is_found = [&](const EffectType* type) { return holds(effects, type); };
  const auto is_law = [](const EffectSetting& effect) { return effect.type->replacement != nullptr; };
  std::vector<EffectSetting> rest = without(effects, position);
  const bool law_stays = std::ranges::any_of(rest, is_law);
  const bool is_another_law = candidate.type->replacement != nullptr;
  if (is_found(candidate.type) || (law_stays && (is_another_law || is_of_law(*candidate.type)))) return {};
  if (is_another_law) std::erase_if(rest, [](const EffectSetting& effect) { return is_of_law(*effect.type); });
  std::vector<EffectSetting> instead = candidate.fit.effects;
  std::erase_if(instead, [&](const EffectSetting& e) { return e.type != candidate.type && is_found(e.type); });
  instead.insert(instead.end(), rest.begin(), rest.end());
  std::vector<std::vector<EffectSetting>> starts{instead};
  if (!candidate.fit.with_nuisance) return starts;
  for (const EffectSetting& number : wrong_numbers(problem, candidate.fit)) {
    const bool is_new = !is_found(number.type) && number.type != candidate.type;
    if (is_new && !(law_stays && is_of_law(*number.type))) instead.push_back(number);
  }
  if (instead.size() > starts.front().size()) starts.push_back(std::move(instead));
  return starts;
}

/// Whether a law that replaces the model's has the same form: it differs in its numbers alone.
bool has_own_form(const SiteModel& model, const EffectSetting& replacement) {
  if (!model.make_law) return false;
  SiteModel replaced = model;
  add_effect(replaced, replacement);
  const std::unique_ptr<Law> law = law_of(replaced);
  const std::unique_ptr<Law> own = model.make_law();
  const Law& first = *law;
  const Law& second = *own;
  return typeid(first) == typeid(second);
}

/// The chosen effect against others in its place, beside the effects that were found with it: by itself a candidate is
/// judged without them. Of a law all laws are tried and the numbers of the model's own, which by themselves may not
/// show that they are off, and of everything the best few; but a number of the model's law stays a number, and does not
/// become a law of the same form. A number of the model is expected to be off: an effect that is none has to be
/// decidedly better.
/// @return whether another one is better by more than a parameter costs.
bool exchange(const IdentificationProblem& problem, const Selection& selection, std::size_t position, Growth& growth) {
  const std::vector<EffectSetting> effects = growth.fit.effects;
  const bool is_law = effects[position].type->replacement != nullptr;
  const auto expected = [&](const EffectType& type) { return is_number(problem, type) ? decisive_gain(problem) : 0.0; };
  std::vector<double> scores{score_of(problem, growth.fit) + expected(*effects[position].type)};
  std::optional<Candidate> best;
  double highest = scores.front() + tuning::kParameterPrior;  // a tie changes nothing
  const auto compare = [&](std::optional<Candidate> instead) {
    if (!instead) return;
    scores.push_back(score_of(problem, instead->fit) + expected(*instead->type));
    if (scores.back() <= highest) return;
    highest = scores.back();
    best = std::move(instead);
  };
  std::size_t others = 0;
  for (const Candidate& candidate : selection.library) {
    const bool is_another_law = candidate.type->replacement != nullptr;
    if (is_another_law && !is_law && has_own_form(problem.model, candidate.fit.effects.front())) continue;
    const bool is_of_law_too = is_law && (is_another_law || is_of_law(*candidate.type));
    if (!is_of_law_too && others >= tuning::kRefittedPairs) continue;
    const std::vector<std::vector<EffectSetting>> starts = with_instead(problem, effects, position, candidate);
    if (!is_of_law_too && !starts.empty()) ++others;
    for (const std::vector<EffectSetting>& start : starts) {
      std::optional<Candidate> instead = fit_together(problem, candidate.type, start, refit_effects);
      if (instead && refutation(problem, *instead).empty()) compare(std::move(instead));
    }
  }
  // Which of the numbers are needed is asked at the end.
  if (is_law) {
    std::vector<EffectSetting> start = without(effects, position);
    for (const EffectSetting& number : numbers_of(problem)) {
      if (!holds(start, number.type)) start.push_back(number);
    }
    const EffectType* const stiffness = find_effect(EffectInterface::specimen, ModelNumber::stiffness);
    if (holds(start, stiffness)) compare(fit_together(problem, stiffness, start, refit_effects));
  }
  if (!best) return false;
  const auto place = std::ranges::max_element(scores) - scores.begin();
  growth.accepted.push_back({best->type, softmax(scores)[static_cast<std::size_t>(place)]});
  growth.fit = std::move(best->fit);
  return true;
}

/// Each chosen effect in turn.
void settle_effects(const IdentificationProblem& problem, const Selection& selection, Growth& growth) {
  for (std::size_t position = 0; position < growth.fit.effects.size(); ++position) {
    exchange(problem, selection, position, growth);
  }
}

/// A number of the model in place of two effects of its interface that are not both numbers: a bandwidth that is off is
/// nearly a delay and another bandwidth. Two have to be decidedly better than one that is expected to be off.
/// @return whether one was found.
bool merge(const IdentificationProblem& problem, Growth& growth) {
  const std::vector<EffectSetting> effects = growth.fit.effects;
  const double both = score_of(problem, growth.fit);
  std::optional<Candidate> best;
  double highest = both - decisive_gain(problem);
  const auto try_instead_of = [&](std::size_t first, std::size_t second, const EffectSetting& number) {
    std::vector<EffectSetting> start = without(without(effects, second), first);
    start.push_back(number);
    std::optional<Candidate> one = fit_together(problem, number.type, start, search_effects);
    if (!one || !refutation(problem, *one).empty() || score_of(problem, one->fit) <= highest) return;
    highest = score_of(problem, one->fit);
    best = std::move(one);
  };
  for (const EffectSetting& number : numbers_of(problem)) {
    if (holds(effects, number.type)) continue;
    for (std::size_t second = 1; second < effects.size(); ++second) {
      for (std::size_t first = 0; first < second; ++first) {
        const EffectType& one = *effects[first].type;
        const EffectType& other = *effects[second].type;
        const bool are_its = one.interface == number.type->interface && other.interface == number.type->interface;
        const bool is_a_law = one.replacement != nullptr || other.replacement != nullptr;
        if (!are_its || is_a_law || (is_number(problem, one) && is_number(problem, other))) continue;
        try_instead_of(first, second, number);
      }
    }
  }
  if (!best) return false;
  growth.accepted.push_back({best->type, softmax({highest + decisive_gain(problem), both}).front()});
  growth.fit = std::move(best->fit);
  return true;
}

/// With the round's best, if it is accepted.
std::optional<Growth> grown(const IdentificationProblem& problem, const FitOutcome& by_numbers, const Growth& from,
                            const std::vector<Candidate>& beside) {
  const Candidate* const next = first_that_earns(problem, by_numbers, from.fit, beside);
  if (next == nullptr) return {};
  Growth growth = from;
  growth.fit = next->fit;
  const auto position = static_cast<std::size_t>(next - beside.data());
  growth.accepted.push_back({next->type, softmax(scores_of(beside))[position]});
  return growth;
}

/// Further effects one by one, until none is accepted: first beside what was found as it is, and where that finds
/// nothing, with the numbers of the model free, which a further effect may move.
/// @param numbers   how the first one is looked for.
void grow_further(const IdentificationProblem& problem, const IdentificationProblem& coarse, const Selection& selection,
                  Numbers numbers, std::size_t threads, const PartProgress& progress, Growth& growth) {
  for (std::size_t round = 0;
       growth.fit.effects.size() < tuning::kEffectsMax && gap_energy(problem, growth.fit).is_clear(); ++round) {
    const std::vector<Candidate> beside = fit_beside(problem, coarse, growth.fit.effects, numbers, threads,
                                                     progress.round(round, 2 * tuning::kEffectsMax));
    if (std::optional<Growth> next = grown(problem, selection.by_numbers, growth, beside)) {
      growth = std::move(*next);
      numbers = Numbers::as_found;
    } else if (numbers == Numbers::as_found) {
      numbers = Numbers::free;
    } else {
      break;
    }
  }
}

/// An effect that earned its place beside those that are left.
bool is_lost(const IdentificationProblem& problem, const FitOutcome& by_numbers, const FitOutcome& left,
             const FitOutcome& before) {
  return std::ranges::any_of(before.effects, [&](const EffectSetting& effect) {
    return !holds(left.effects, effect.type) &&
           earns_its_place(problem, by_numbers, left, {.type = effect.type, .fit = before});
  });
}

/// Which effects are needed, when all are known: compared at the lower rate, at a fraction of the cost. What is lost so
/// at the full rate is asked there: what moves within a few samples, as a slip, hardly exists at the lower one.
/// @return whether an effect was dropped.
bool settle(const IdentificationProblem& problem, const IdentificationProblem& coarse, const Selection& selection,
            Growth& growth) {
  const Growth before = growth;
  const std::size_t count = before.fit.effects.size();
  // By itself an effect has been compared already, but for a law with what the numbers of the model's own may do.
  if (count == 0 || (count == 1 && growth.fit.effects.front().type->replacement == nullptr)) return false;
  growth.fit = refit_effects(coarse, growth.fit.effects, false);
  settle_effects(coarse, selection, growth);
  merge(coarse, growth);
  prune(coarse, refit_effects(coarse, selection.by_numbers.effects, false), growth.fit);
  growth.fit = refit_effects(problem, growth.fit.effects, false);
  if (is_lost(problem, selection.by_numbers, growth.fit, before.fit)) {
    growth = before;
    prune(problem, selection.by_numbers, growth.fit);
    // One effect at a time may go astray: then all are kept.
    if (is_lost(problem, selection.by_numbers, growth.fit, before.fit)) growth = before;
  }
  return growth.fit.effects.size() < count;
}

/// Whether this candidate is grown: the first one is, and one that scores nearly as well; where a sensor's effect
/// leads, also one of a stage that leaves not much more. The same under another name is not.
bool may_lead(const IdentificationProblem& problem, const Selection& selection, std::size_t position) {
  if (position == 0) return true;
  const Candidate& first = selection.library.front();
  const Candidate& candidate = selection.library[position];
  if (are_alike(first.fit, candidate.fit)) return false;
  if (candidate.score > first.score - tuning::kFarBehind) return true;
  return is_of_sensor(*first.type) && !is_of_sensor(*candidate.type) &&
         tuning::kAnotherEffectLeaves * gap_energy(problem, candidate.fit).excess() <
             gap_energy(problem, first.fit).excess();
}

/// A leading candidate, at its position in the library.
struct Leader {
  std::size_t position = 0;
  Growth growth;
};

/// The numbers of the model in the library, where none of them shows by itself that it is off.
void add_numbers(Selection& selection) {
  const FitOutcome& numbers = selection.by_numbers;
  const bool is_there = std::ranges::any_of(
      selection.library, [&](const Candidate& candidate) { return holds(numbers.effects, candidate.type); });
  if (is_there || numbers.effects.empty()) return;
  selection.library.push_back({.type = numbers.effects.front().type,
                               .fit = numbers,
                               .parameters = static_cast<double>(numbers.effects.size())});
}

/// The numbers of the model that are needed, if nothing is left beside them, or else all: beside another effect others
/// may be needed. At the position of the one that explains most by itself; nothing where they do not explain anything.
std::optional<Leader> leader_of_numbers(const IdentificationProblem& problem, const Selection& selection) {
  const FitOutcome& all = selection.by_numbers;
  const auto first = std::ranges::find_if(
      selection.library, [&](const Candidate& candidate) { return holds(all.effects, candidate.type); });
  const double gain = held_out_score(problem, all) - held_out_score(problem, selection.baseline);
  if (first == selection.library.end() || gain <= decisive_gain(problem)) return {};
  FitOutcome needed = all;
  prune(problem, all, needed);
  const auto position = static_cast<std::size_t>(first - selection.library.begin());
  return Leader{position, {gap_energy(problem, needed).is_clear() ? all : needed, {{first->type, 1.0}}}};
}

/// Candidates from which further effects are grown. The numbers of the model come first: they are expected to be off.
/// Where nothing is left beside them, an effect that explains the same has to be decidedly better.
std::vector<Leader> leaders_of(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                               const Selection& selection) {
  std::vector<Leader> leaders;
  const auto is_enough = [&](const Leader& leader) { return !gap_energy(problem, leader.growth.fit).is_clear(); };
  if (std::optional<Leader> numbers = leader_of_numbers(problem, selection)) {
    const bool is_first = score_of(problem, numbers->growth.fit) + decisive_gain(problem) > selection.library[0].score;
    leaders.push_back(std::move(*numbers));
    if (is_first && is_enough(leaders.front())) return leaders;
  }
  const std::size_t count = std::min(tuning::kLeadersPaired, selection.library.size());
  for (std::size_t i = 0; i < count; ++i) {
    if (!may_lead(problem, selection, i) || (!leaders.empty() && leaders.front().position == i)) continue;
    leaders.push_back({i, with_its_numbers(problem, coarse, selection, i)});
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
                                           const Selection& selection, std::size_t threads,
                                           const PartProgress& progress) {
  std::map<std::size_t, Growth> grown_leaders;
  std::vector<Leader> leaders = leaders_of(problem, coarse, selection);
  for (std::size_t i = 0; i < leaders.size(); ++i) {
    Growth& leader = leaders[i].growth;
    if (gap_energy(problem, leader.fit).is_clear()) {
      const std::vector<Candidate> beside = fit_beside(problem, coarse, leader.fit.effects, Numbers::as_found, threads,
                                                       progress.round(i, leaders.size()));
      if (std::optional<Growth> pair = grown(problem, selection.by_numbers, leader, beside)) leader = std::move(*pair);
    }
    const std::size_t position = place_of_found(selection, leaders[i]);
    const auto [place, is_new] = grown_leaders.try_emplace(position, leader);
    if (!is_new && score_of(problem, leader.fit) > score_of(problem, place->second.fit)) place->second = leader;
  }
  return grown_leaders;
}

/// Between effects that the recordings cannot tell apart, the score decides nothing.
void share_evenly(const std::vector<AlikeLeader>& alike, std::vector<double>& probabilities) {
  double sum = 0.0;
  for (const AlikeLeader& leader : alike) sum += probabilities[leader.position];
  for (const AlikeLeader& leader : alike) probabilities[leader.position] = sum / static_cast<double>(alike.size());
}

/// Numbers of the model that lead alone are preferred to what has to be decidedly better than they are: that is their
/// probability, too.
void weigh_numbers(const IdentificationProblem& problem, std::size_t position, Growth& growth, Selection& selection) {
  if (!holds(selection.by_numbers.effects, selection.library[position].type)) return;
  std::vector<double> scores = scores_of(selection.library);
  scores[position] = std::max(scores[position], score_of(problem, growth.fit) + decisive_gain(problem));
  selection.probabilities = softmax(std::move(scores));
  growth.accepted.front().probability = selection.probabilities[position];
}

/// The best of the leading candidates; of a sensor only if none of a stage changes the prediction alike. The
/// probabilities become those of what was found with them.
Growth best_start(const IdentificationProblem& problem, const IdentificationProblem& coarse, Selection& selection,
                  std::size_t threads, const PartProgress& progress) {
  std::map<std::size_t, Growth> leaders = grow_leaders(problem, coarse, selection, threads, progress);
  if (leaders.size() == 1) {
    auto& [position, growth] = *leaders.begin();
    weigh_numbers(problem, position, growth, selection);
    return std::move(growth);
  }
  const auto by_score = [&](const auto& leader) { return score_of(problem, leader.second.fit); };
  auto best = std::ranges::max_element(leaders, {}, by_score);
  const auto is_alike = [&](const auto& leader) { return are_alike(best->second.fit, leader.second.fit); };
  if (is_of_sensor(*selection.library[best->first].type)) {
    const auto of_stage = std::ranges::find_if(leaders, [&](const auto& leader) {
      return !is_of_sensor(*selection.library[leader.first].type) && is_alike(leader);
    });
    if (of_stage != leaders.end()) best = of_stage;
  }
  std::vector<double> scores = scores_of(selection.library);
  for (const auto& leader : leaders) {
    // What stands beside the best, or beside which the best stands, is not in its place; nor is what was dropped from
    // what was found with it.
    const EffectType* const type = selection.library[leader.first].type;
    const bool is_there = holds(leader.second.fit.effects, type);
    const bool is_instead = is_there && !holds(best->second.fit.effects, type) &&
                            !holds(leader.second.fit.effects, selection.library[best->first].type);
    if (leader.first != best->first && !is_instead) continue;
    scores[leader.first] = std::max(scores[leader.first], by_score(leader));
    if (is_there && is_alike(leader)) selection.alike.push_back({leader.first, leader.second.fit});
  }
  selection.probabilities = softmax(std::move(scores));
  share_evenly(selection.alike, selection.probabilities);
  best->second.accepted.front().probability = selection.probabilities[best->first];
  return std::move(best->second);
}

/// Gap explained by the effects whose bits are set.
std::vector<double> explained_by_subset(const IdentificationProblem& problem, const std::vector<EffectSetting>& chosen,
                                        const PartProgress& progress) {
  const std::size_t subsets = std::size_t{1} << chosen.size();
  const double total = gap_energy(problem, fit_nothing(problem, false)).total;
  std::vector<double> explained(subsets, 0.0);
  for (std::size_t subset = 1; subset < subsets; ++subset) {
    progress.report("combinations of the causes", subset - 1, subsets - 1);
    std::vector<EffectSetting> effects;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if ((subset >> i & 1U) != 0) effects.push_back(chosen[i]);
    }
    explained[subset] = std::max(0.0, total - gap_energy(problem, refit_effects(problem, effects, false)).total);
  }
  return explained;
}

double factorial(int n) { return std::tgamma(n + 1.0); }

/// What each of several effects contributes to the gap that they explain together (Shapley, 1953): its
/// gain on held-out blocks, averaged over all orders in which they can be added. Adds up to one.
std::vector<double> cause_shares(const IdentificationProblem& problem, const std::vector<EffectSetting>& chosen,
                                 const PartProgress& progress) {
  const auto n = static_cast<int>(chosen.size());
  std::vector<double> shares(chosen.size(), 1.0 / std::max(1, n));
  if (n < 2) return shares;
  const std::vector<double> explained = explained_by_subset(problem, chosen, progress);
  if (explained.back() <= 0.0) return shares;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    double value = 0.0;
    for (std::size_t subset = 0; subset < explained.size(); ++subset) {
      if ((subset >> i & 1U) != 0) continue;
      const int before = std::popcount(subset);
      value += factorial(before) * factorial(n - before - 1) / factorial(n) *
               (explained[subset | std::size_t{1} << i] - explained[subset]);
    }
    shares[i] = std::max(0.0, value);
  }
  const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (double& share : shares) share = sum > 0.0 ? share / sum : 1.0 / n;
  return shares;
}

}  // namespace

bool stands_above_floor(const IdentificationProblem& problem, const FitOutcome& baseline, double multiple) {
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    if (!fit.is_suspect) continue;
    const double gap = baseline.segments[i].mean_square - fit.floor * fit.floor;
    const double floor = fit.sample_floor;
    const double allowance = std::max(0.0, 1.0 / (fit.weight * fit.weight) - fit.floor * fit.floor);
    if (gap > multiple * multiple * floor * floor + allowance) return true;
  }
  return false;
}

namespace {

/// The effects that explain the gap, from the library as it stands.
Growth find_effects(const IdentificationProblem& problem, const IdentificationProblem& coarse, Selection& selection,
                    std::size_t threads, const PartProgress& progress) {
  Growth growth =
      best_start(problem, coarse, selection, threads, progress.part(tuning::kLibraryFitted, tuning::kPairsFitted));
  const PartProgress further = progress.part(tuning::kPairsFitted, tuning::kEffectsChosen);
  // Beside a leader alone nothing was accepted.
  const Numbers numbers = growth.accepted.size() > 1 ? Numbers::as_found : Numbers::free;
  grow_further(problem, coarse, selection, numbers, threads, further, growth);
  // In place of what was dropped, something else may be needed.
  if (settle(problem, coarse, selection, growth)) {
    grow_further(problem, coarse, selection, Numbers::as_found, threads, further, growth);
    settle(problem, coarse, selection, growth);
  }
  return growth;
}

/// The noise is known better beside what was found than it was beside the best effect by itself. Where the floor was
/// too high for that, what it hid is looked for.
void look_again(IdentificationProblem& problem, IdentificationProblem& coarse, Selection& selection,
                std::size_t threads, const PartProgress& progress, Growth& growth) {
  if (growth.fit.effects.empty() || gap_energy(problem, growth.fit).is_clear()) return;
  IdentificationProblem settled = problem;
  settle_noise(settled, growth.fit);
  if (!gap_energy(settled, growth.fit).is_clear()) return;
  problem = std::move(settled);
  settle_noise(coarse, refit_effects(coarse, growth.fit.effects, false));
  growth.fit = refit_effects(problem, growth.fit.effects, false);
  score_again(problem, selection.library);
  grow_further(problem, coarse, selection, Numbers::as_found, threads, progress, growth);
  settle(problem, coarse, selection, growth);
}

/// Removes a law without a loop from the library, if one was found.
bool drop_law_without_loop(const IdentificationProblem& problem, const FitOutcome& found, Selection& selection) {
  for (std::size_t i = 0; i < found.effects.size(); ++i) {
    if (!is_law_without_loop(problem, found, i)) continue;
    std::erase_if(selection.library,
                  [&](const Candidate& candidate) { return candidate.type == found.effects[i].type; });
    selection.alike.clear();
    selection.probabilities = softmax(scores_of(selection.library));
    return true;
  }
  return false;
}

/// Where what was found leaves something to explain: the law of a special device instead, if it is decidedly better by
/// itself. Nothing is looked for beside it: what it leaves is told as left.
void try_special_laws(const IdentificationProblem& problem, const IdentificationProblem& coarse, Selection& selection,
                      std::size_t threads, const PartProgress& progress, Growth& growth) {
  if (!gap_energy(problem, growth.fit).is_clear()) return;
  std::vector<Candidate> laws = fit_special_laws(problem, coarse, threads, progress);
  const double before = score_of(problem, growth.fit);
  if (laws.empty() || laws.front().score <= before + decisive_gain(problem)) return;
  std::vector<double> scores = scores_of(laws);
  scores.push_back(before);
  const double probability = softmax(scores).front();
  Candidate& law = laws.front();
  growth = {.fit = law.fit, .accepted = {{law.type, probability}}};
  for (double& other : selection.probabilities) other *= 1.0 - probability;
  selection.probabilities.insert(selection.probabilities.begin(), probability);
  selection.library.insert(selection.library.begin(), std::move(law));
  selection.alike.clear();
}

/// Whether a fit left nothing of an effect.
bool is_gone(const IdentificationProblem& problem, const EffectSetting& effect) {
  if (place_of(problem.model, *effect.type) != nullptr) return false;
  bool has_size = false;
  for (std::size_t i = 0; i < effect.values.size(); ++i) {
    const EffectParameter& parameter = effect.type->parameters[i];
    if (std::isnan(parameter.neutral) || is_fixed(problem, *effect.type, parameter)) continue;
    has_size = true;
    if (effect.values[i] != parameter.neutral) return false;
  }
  return has_size;
}

}  // namespace

void drop_gone(const IdentificationProblem& problem, FitOutcome& fit) {
  std::vector<EffectSetting> left = fit.effects;
  std::erase_if(left, [&](const EffectSetting& effect) { return is_gone(problem, effect); });
  if (left.empty() || left.size() == fit.effects.size()) return;
  fit = refit_effects(problem, left, false);
}

Selection select_effects(IdentificationProblem& problem, IdentificationProblem& coarse, std::size_t threads,
                         const PartProgress& progress) {
  Selection selection;
  selection.baseline = fit_nothing(problem, false);
  selection.chosen = selection.baseline;
  if (!stands_above_floor(problem, selection.baseline, tuning::kGapOverFloor)) return selection;
  selection.library = fit_library(problem, coarse, threads, progress.part(0.0, tuning::kLibraryFitted));
  if (selection.library.empty()) return selection;
  // Under a large gap the noise is not known: it is that of the best candidate, and the others are judged by it.
  const Candidate& best = selection.library.front();
  // The best may be a fit at the lower rate: one that came nowhere near, until the others were fitted again.
  settle_noise(problem, refit_effects(problem, best.fit.effects, best.fit.with_nuisance));
  settle_noise(coarse, refit_effects(coarse, best.fit.effects, best.fit.with_nuisance));
  selection.by_numbers = fit_numbers(problem, coarse);
  add_numbers(selection);
  score_again(problem, selection.library);
  put_stage_before_sensor(selection.library);
  selection.probabilities = softmax(scores_of(selection.library));
  const auto is_explained = [&] {
    return !selection.library.empty() &&
           selection.library.front().score >= held_out_score(problem, selection.baseline) + decisive_gain(problem);
  };
  Growth growth{.fit = selection.baseline, .accepted = {}};
  if (is_explained()) growth = find_effects(problem, coarse, selection, threads, progress);
  if (drop_law_without_loop(problem, growth.fit, selection)) {
    growth = {.fit = selection.baseline, .accepted = {}};
    if (is_explained()) growth = find_effects(problem, coarse, selection, threads, progress);
  }
  look_again(problem, coarse, selection, threads, progress.part(tuning::kPairsFitted, tuning::kEffectsChosen), growth);
  try_special_laws(problem, coarse, selection, threads, progress.part(tuning::kPairsFitted, tuning::kEffectsChosen),
                   growth);
  if (growth.fit.effects.empty()) return selection;
  // Of what was chosen at the lower rate, the full rate may leave nothing.
  drop_gone(problem, growth.fit);
  selection.shares = cause_shares(coarse, growth.fit.effects, progress.part(tuning::kEffectsChosen, 1.0));
  selection.chosen = std::move(growth.fit);
  for (const EffectSetting& effect : selection.chosen.effects) {
    selection.chosen_probabilities.push_back(growth.probability_of(effect.type));
  }
  return selection;
}

}  // namespace hybridtest
