#include "diagnosis/verdict/growth.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/identification/law_candidates.hpp"
#include "diagnosis/identification/search.hpp"
#include "diagnosis/tuning.hpp"
#include "diagnosis/verdict/held_out_loss.hpp"
#include "diagnosis/verdict/refutations.hpp"
#include "diagnosis/verdict/typical_recording.hpp"

namespace hybridtest {

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

void weigh(std::vector<Candidate>& candidates, std::vector<double> scores) {
  const std::vector<double> probabilities = softmax(std::move(scores));
  for (std::size_t i = 0; i < candidates.size(); ++i) candidates[i].probability = probabilities[i];
}

double score_of(const IdentificationProblem& problem, const FitOutcome& fit) {
  return held_out_score(problem, fit) + prior(problem, fit);
}

bool holds(const std::vector<EffectSetting>& effects, const EffectType* type) {
  return std::ranges::find(effects, type, &EffectSetting::type) != effects.end();
}

std::vector<EffectSetting> without(const std::vector<EffectSetting>& effects, std::size_t position) {
  std::vector<EffectSetting> rest = effects;
  rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(position));
  return rest;
}

bool changes_at_most(const IdentificationProblem& problem, const EffectSetting& effect, double share) {
  return std::ranges::all_of(problem.segments, [&](const FitSegment& fit) {
    if (!fit.is_suspect || !fit.segment.touched_by(*effect.type)) return true;
    return (predict(problem, fit, std::span{&effect, 1}) - fit.baseline).norm() <= share * fit.measured.norm();
  });
}

bool earns_its_place(const IdentificationProblem& problem, const FitOutcome& by_numbers, const FitOutcome& without,
                     const Candidate& with) {
  const double gain = held_out_score(problem, with.fit) - held_out_score(problem, without);
  if (gain <= decisive_gain(problem)) return false;
  if (is_number(problem, *with.type)) return true;
  const Typical change = typical(problem, by_numbers, without, with);
  const bool matters = change.explains > tuning::kAnotherEffectExplains || change.leaves < tuning::kSmallEffectLeaves;
  return change.leaves < tuning::kAnotherEffectLeaves && matters;
}

namespace {

/// A number that may be off: a zero is known exactly before a test.
bool may_be_off(const IdentificationProblem& problem, const EffectType& type) {
  return is_number(problem, type) && type.traits.number != ModelNumber::offset;
}

/// The judged effects of this kind that the model does not have, each absent.
template <class Predicate>
std::vector<EffectSetting> absent_ones(const IdentificationProblem& problem, Predicate&& is_of_kind) {
  std::vector<EffectSetting> effects;
  for (const EffectType* const type : judged_effects(problem)) {
    if (is_of_kind(*type) && place_of(problem.model, *type) == nullptr) effects.push_back(absent(*type));
  }
  return effects;
}

}  // namespace

std::vector<EffectSetting> numbers_of(const IdentificationProblem& problem) {
  return absent_ones(problem, [&](const EffectType& type) {
    // Strength and hardening free beside a stiffness make any law that softens of one that yields.
    return may_be_off(problem, type) && type.traits.number != ModelNumber::hardening;
  });
}

std::vector<EffectSetting> zeros_of(const IdentificationProblem& problem) {
  return absent_ones(problem, [](const EffectType& type) { return type.traits.number == ModelNumber::offset; });
}

namespace {

/// Whether the interval of an effect says that it may be absent only where a number is left out. The number was fitted,
/// so it is known better than one that the model has.
bool makes_needless(const IdentificationProblem& problem, const FitOutcome& fit, std::size_t number,
                    const FitOutcome& rest) {
  if (!is_number(problem, *fit.effects[number].type)) return false;
  for (std::size_t i = 0; i < rest.effects.size(); ++i) {
    const bool was_first = i < number;
    if (is_number(problem, *rest.effects[i].type) || !is_needless(problem, rest, i)) continue;
    if (!is_needless(problem, fit, was_first ? i : i + 1)) return true;
  }
  return false;
}

/// The numbers of the model behind the effects that are there; of its law only where no other one is in its place.
std::vector<EffectSetting> with_all_numbers(const IdentificationProblem& problem, std::vector<EffectSetting> effects) {
  const bool has_other_law = std::ranges::any_of(effects, replaces_law);
  for (const EffectSetting& number : numbers_of(problem)) {
    if (!holds(effects, number.type) && !(has_other_law && is_of_law(*number.type))) effects.push_back(number);
  }
  return effects;
}

/// Without one effect. Where that is decidedly worse, the numbers of the model, in whose doubt the effect stands, may
/// be what it stood for.
FitOutcome without_needless(const IdentificationProblem& problem, const FitOutcome& fit, std::size_t position,
                            FitOutcome rest) {
  if (held_out_score(problem, fit) - held_out_score(problem, rest) < decisive_gain(problem)) return rest;
  const std::vector<EffectSetting> start = with_all_numbers(problem, without(fit.effects, position));
  if (start.size() == rest.effects.size()) return rest;
  FitOutcome by_numbers = refit_effects(problem, start, false);
  return held_out_score(problem, by_numbers) > held_out_score(problem, rest) ? by_numbers : rest;
}

}  // namespace

void prune(const IdentificationProblem& problem, const FitOutcome& by_numbers, FitOutcome& fit) {
  while (fit.effects.size() > 1) {
    std::vector<std::optional<FitOutcome>> rests(fit.effects.size());  // without each effect that can be done without
    problem.workers.for_each(rests.size(), [&](std::size_t i) {
      FitOutcome rest = refit_effects(problem, without(fit.effects, i), false);
      const EffectType& type = *fit.effects[i].type;
      const bool is_needed =
          !is_needless(problem, fit, i) && earns_its_place(problem, by_numbers, rest, {.type = &type, .fit = fit});
      if (is_needed || makes_needless(problem, fit, i, rest)) return;
      rests[i] = is_number(problem, type) ? std::move(rest) : without_needless(problem, fit, i, std::move(rest));
    });
    std::erase(rests, std::nullopt);
    if (rests.empty()) return;
    const auto score = [&](const std::optional<FitOutcome>& rest) { return held_out_score(problem, *rest); };
    fit = *std::move(*std::ranges::max_element(rests, {}, score));
  }
}

namespace {

/// How much better than a number of the model what is none has to be: a number is expected to be off [nats].
double expected(const IdentificationProblem& problem, const EffectType& type) {
  return is_number(problem, type) ? decisive_gain(problem) : 0.0;
}

/// The best of `beside` that is accepted, with its probability; nothing where there is none. A wrong number of the
/// model that explains nearly as much is preferred, so that it is not called a missing effect: those that are refused
/// are not in its place. An effect that is no number is doubtful where what is refused predicts better.
std::optional<std::pair<const Candidate*, double>> first_that_earns(const IdentificationProblem& problem,
                                                                    const FitOutcome& by_numbers,
                                                                    const FitOutcome& without,
                                                                    const std::vector<Candidate>& beside) {
  const double before = gap_energy(problem, without).excess();
  std::vector<const Candidate*> earning;
  std::vector<double> scores;
  for (const Candidate& candidate : beside) {
    // What predicts better by moving the others, and leaves more of the gap, explains nothing of it.
    if (gap_energy(problem, candidate.fit).excess() >= before) continue;
    if (!earns_its_place(problem, by_numbers, without, candidate)) continue;
    earning.push_back(&candidate);
    scores.push_back(candidate.score);
  }
  if (earning.empty()) return {};
  const double enough = tuning::kNumberInstead * (before - gap_energy(problem, earning.front()->fit).excess());
  const auto number = std::ranges::find_if(earning, [&](const Candidate* candidate) {
    return is_model_number(problem, *candidate->type) && before - gap_energy(problem, candidate->fit).excess() > enough;
  });
  const auto place = static_cast<std::size_t>(number == earning.end() ? 0 : number - earning.begin());
  const Candidate* const chosen = earning[place];
  if (!may_be_off(problem, *chosen->type)) {
    return std::pair{chosen, softmax(scores_of(beside))[static_cast<std::size_t>(chosen - beside.data())]};
  }
  scores[place] += expected(problem, *chosen->type);
  return std::pair{chosen, softmax(std::move(scores))[place]};
}

/// A law in the place of one that has all of its parameters and more, and as they are there; else nothing.
std::optional<EffectSetting> simplified(const EffectType& simpler, const EffectSetting& law) {
  if (law.type->replacement == nullptr || simpler.parameters.size() >= law.values.size()) return {};
  EffectSetting result{.type = &simpler, .values = {}};
  for (const EffectParameter& parameter : simpler.parameters) {
    const auto same = std::ranges::find(law.type->parameters, parameter.name, &EffectParameter::name);
    if (same == law.type->parameters.end()) return {};
    result.values.push_back(law.values[static_cast<std::size_t>(same - law.type->parameters.begin())]);
  }
  return result;
}

/// A candidate in the place of one effect, and what was found beside that one; by itself, and with the numbers of the
/// model that it needed. The numbers of a law that another law replaces go with it. In the place of a law the numbers
/// of the model's own are free, too: the law has taken up what they are off. None where the candidate is found already.
std::vector<std::vector<EffectSetting>> with_instead(const IdentificationProblem& problem,
                                                     const std::vector<EffectSetting>& effects, std::size_t position,
                                                     const Candidate& candidate) {
  const auto is_found = [&](const EffectType* type) { return holds(effects, type); };
  std::vector<EffectSetting> rest = without(effects, position);
  const bool law_stays = std::ranges::any_of(rest, replaces_law);
  const bool is_another_law = candidate.type->replacement != nullptr;
  if (is_found(candidate.type) || (law_stays && (is_another_law || is_of_law(*candidate.type)))) return {};
  if (is_another_law) std::erase_if(rest, [](const EffectSetting& effect) { return is_of_law(*effect.type); });
  std::vector<EffectSetting> instead = candidate.fit.effects;
  std::erase_if(instead, [&](const EffectSetting& e) { return e.type != candidate.type && is_found(e.type); });
  instead.insert(instead.end(), rest.begin(), rest.end());
  std::vector<std::vector<EffectSetting>> starts{instead};
  if (replaces_law(effects[position]) && !is_another_law) {
    std::vector<EffectSetting> with_numbers = with_all_numbers(problem, instead);
    if (with_numbers.size() > instead.size()) starts.push_back(std::move(with_numbers));
  }
  if (!candidate.fit.with_nuisance) return starts;
  for (const EffectSetting& number : wrong_numbers(problem, candidate.fit)) {
    const bool is_new = !is_found(number.type) && number.type != candidate.type;
    if (is_new && !(law_stays && is_of_law(*number.type))) instead.push_back(number);
  }
  if (instead.size() > starts.front().size()) starts.push_back(std::move(instead));
  return starts;
}

/// Without the numbers of the model, beside the effect, that its fit does not need.
Candidate without_needless_numbers(const IdentificationProblem& problem, Candidate candidate) {
  const FitOutcome& fit = candidate.fit;
  std::vector<EffectSetting> needed;
  for (std::size_t i = 0; i < fit.effects.size(); ++i) {
    const EffectType* const type = fit.effects[i].type;
    if (type == candidate.type || !is_number(problem, *type) || !is_needless(problem, fit, i)) {
      needed.push_back(fit.effects[i]);
    }
  }
  if (needed.size() < fit.effects.size()) candidate.fit = refit_effects(problem, needed, false);
  return candidate;
}

/// Whether several numbers of the model that are slightly off beside one effect have to be far off beside another.
bool pushes_numbers(const IdentificationProblem& problem, const std::vector<EffectSetting>& with_one,
                    const std::vector<EffectSetting>& with_another) {
  const auto is_slight = [&](const EffectSetting& number) {
    return changes_at_most(problem, number, 2.0 * tuning::kNumbersWithin);
  };
  const auto pushed = std::ranges::count_if(with_another, [&](const EffectSetting& number) {
    const auto own = std::ranges::find(with_one, number.type, &EffectSetting::type);
    return own != with_one.end() && is_number(problem, *number.type) && is_slight(*own) && !is_slight(number);
  });
  return pushed > 1;
}

/// What is tried in the place of an effect, and its fit beside the others.
struct Tried {
  const EffectType* type = nullptr;
  std::vector<EffectSetting> start;
  std::optional<Candidate> fitted;
};

/// All numbers of the model's law, its hardening too, in the place of an effect of the specimen: a friction that yields
/// where the law does is a law with another strength. Nothing for a number, or a law without a hardening.
std::optional<Candidate> whole_law_instead(const IdentificationProblem& problem,
                                           const std::vector<EffectSetting>& effects, std::size_t position) {
  const EffectType& type = *effects[position].type;
  const EffectType* const hardening = find_effect(EffectInterface::specimen, ModelNumber::hardening);
  if (type.interface != EffectInterface::specimen || is_number(problem, type)) return {};
  if (std::ranges::any_of(effects, replaces_law) || holds(effects, hardening)) return {};
  if (!is_judged(problem, *hardening) || place_of(problem.model, *hardening) != nullptr) return {};
  std::vector<EffectSetting> start = with_all_numbers(problem, without(effects, position));
  start.push_back(absent(*hardening));
  std::optional<Candidate> numbers = fit_together(problem, hardening, start, refit_effects);
  if (numbers) numbers = without_needless_numbers(problem, *std::move(numbers));
  return numbers;
}

/// The chosen effect against others in its place, beside the effects that were found with it: by itself a candidate is
/// judged without them. Of a law all laws are tried and the numbers of the model's own, which by themselves may not
/// show that they are off, of what fades all that it may fade with, and of everything the best few; but a number of the
/// model's law stays a number, and does not become a law of the same form. A number of the model is expected to be off:
/// an effect that is none has to be decidedly better. But it is expected to be off by itself: than what needs several
/// others to be far off, an effect beside which they are slightly off is decidedly better.
void exchange(const IdentificationProblem& problem, const Selection& selection, std::size_t position, Growth& growth) {
  const std::vector<EffectSetting> effects = growth.fit.effects;
  const bool is_law = replaces_law(effects[position]);
  const double own = score_of(problem, growth.fit) + expected(problem, *effects[position].type);
  // Of all that were compared, this one first.
  std::vector<double> scores{own};
  std::vector<Instead> compared{{.type = effects[position].type, .fit = growth.fit}};
  std::optional<Candidate> best;
  double highest = own + tuning::kParameterPrior;  // a tie changes nothing
  const auto compare = [&](std::optional<Candidate> instead) {
    if (!instead) return;
    double score = score_of(problem, instead->fit);
    if (!pushes_numbers(problem, effects, instead->fit.effects)) score += expected(problem, *instead->type);
    if (pushes_numbers(problem, instead->fit.effects, effects)) {
      score += decisive_gain(problem) + expected(problem, *effects[position].type);
    }
    // What is no simpler has to predict better for certain; else they are even.
    const bool is_simpler = instead->fit.effects.size() < effects.size();
    const bool is_better = score > highest && (is_simpler || loss_by(problem, growth.fit, instead->fit).is_certain());
    scores.push_back(is_better ? score : std::min(score, own));
    compared.push_back({.type = instead->type, .fit = instead->fit});
    if (!is_better) return;
    highest = score;
    best = std::move(instead);
  };
  std::vector<Tried> tried;
  std::size_t others = 0;
  for (const Candidate& candidate : selection.library) {
    const bool is_another_law = candidate.type->replacement != nullptr;
    if (is_another_law && !is_law && has_own_form(problem.model, candidate.fit.effects.front())) continue;
    const bool is_of_law_too = is_law && (is_another_law || is_of_law(*candidate.type));
    const bool is_of_kind = is_of_law_too || (degrades(*candidate.type) && degrades(*effects[position].type));
    if (!is_of_kind && others >= tuning::kRefittedPairs) continue;
    std::vector<std::vector<EffectSetting>> starts = with_instead(problem, effects, position, candidate);
    if (!is_of_kind && !starts.empty()) ++others;
    for (std::vector<EffectSetting>& start : starts) tried.push_back({candidate.type, std::move(start), {}});
  }
  // Beside what was found the simpler law may do, which by itself took that up and may be refuted.
  for (const LawCandidate& law : law_candidates(problem.law_is_spring)) {
    std::optional<EffectSetting> simpler = simplified(law.type, effects[position]);
    if (!simpler) continue;
    std::vector<EffectSetting> start = without(effects, position);
    start.insert(start.begin(), *std::move(simpler));
    tried.push_back({&law.type, std::move(start), {}});
  }
  problem.workers.for_each(tried.size(), [&](std::size_t i) {
    auto& [type, start, fitted] = tried[i];
    fitted = fit_together(problem, type, start, refit_effects);
    const bool is_another_law = type->replacement != nullptr;
    if (fitted && is_law && !is_another_law) fitted = without_needless_numbers(problem, *std::move(fitted));
    if (fitted && !refutation(problem, *fitted).empty()) fitted.reset();
  });
  for (Tried& instead : tried) compare(std::move(instead.fitted));
  // Which of the numbers are needed is asked at the end.
  if (is_law) {
    const std::vector<EffectSetting> start = with_all_numbers(problem, without(effects, position));
    const EffectType* const stiffness = find_effect(EffectInterface::specimen, ModelNumber::stiffness);
    if (holds(start, stiffness)) compare(fit_together(problem, stiffness, start, refit_effects));
  } else if (std::optional<Candidate> numbers = whole_law_instead(problem, effects, position)) {
    // All of them are expected to be off, so they are the simpler answer.
    const double score = score_of(problem, numbers->fit) + decisive_gain(problem);
    scores.push_back(score);
    compared.push_back({.type = numbers->type, .fit = numbers->fit});
    if (score > highest) best = std::move(numbers);
  }
  if (scores.size() < 2) return;
  const std::vector<double> probabilities = softmax(scores);
  for (std::size_t i = 0; i < compared.size(); ++i) compared[i].probability = probabilities[i];
  const auto place = best ? std::ranges::max_element(scores) - scores.begin() : 0;
  Instead chosen = std::move(compared[static_cast<std::size_t>(place)]);
  compared.erase(compared.begin() + place);
  growth.accept({chosen.type, chosen.probability, std::move(compared)});
  if (best) growth.fit = std::move(best->fit);
}

/// Each chosen effect in turn; first the hardening, which is not expected to be off as other numbers of a law are.
void settle_effects(const IdentificationProblem& problem, const Selection& selection, Growth& growth) {
  const auto is_hardening = [](const EffectSetting& effect) {
    return effect.type->traits.number == ModelNumber::hardening;
  };
  const auto hardening = std::ranges::find_if(growth.fit.effects, is_hardening);
  if (hardening != growth.fit.effects.end()) {
    exchange(problem, selection, static_cast<std::size_t>(hardening - growth.fit.effects.begin()), growth);
  }
  for (std::size_t position = 0; position < growth.fit.effects.size(); ++position) {
    exchange(problem, selection, position, growth);
  }
}

/// Whether a number of the model may stand in the place of two effects: of its interface, no laws, not both numbers.
bool may_be_number(const IdentificationProblem& problem, const EffectType& number, const EffectType& one,
                   const EffectType& other) {
  const bool are_its = one.interface == number.interface && other.interface == number.interface;
  const bool is_a_law = one.replacement != nullptr || other.replacement != nullptr;
  return are_its && !is_a_law && !(is_number(problem, one) && is_number(problem, other));
}

/// The zeros of both sensors, which move the path of the law.
bool are_both_zeros(const EffectType& one, const EffectType& other) {
  const auto is_zero = [](const EffectType& type) {
    return is_of_sensor(type) && type.traits.number == ModelNumber::offset;
  };
  return is_zero(one) && is_zero(other) && one.interface != other.interface;
}

/// One effect in place of two, which have to be decidedly better: a number of the model, which is expected to be off,
/// of its interface (a bandwidth that is off is nearly a delay and another bandwidth); or two strengths of the specimen
/// for both sensors' zeros.
void merge(const IdentificationProblem& problem, Growth& growth) {
  const std::vector<EffectSetting> effects = growth.fit.effects;
  const double both = score_of(problem, growth.fit);
  std::vector<EffectSetting> numbers = numbers_of(problem);
  std::erase_if(numbers, [&](const EffectSetting& number) { return holds(effects, number.type); });
  const EffectType* const two_strengths = find_effect(EffectInterface::specimen, "strength_asymmetry");
  std::vector<Tried> tried;
  for (std::size_t second = 1; second < effects.size(); ++second) {
    for (std::size_t first = 0; first < second; ++first) {
      const EffectType& one = *effects[first].type;
      const EffectType& other = *effects[second].type;
      const auto add = [&](const EffectSetting& instead) {
        std::vector<EffectSetting> start = without(without(effects, second), first);
        start.push_back(instead);
        tried.push_back({instead.type, std::move(start), {}});
      };
      for (const EffectSetting& number : numbers) {
        if (may_be_number(problem, *number.type, one, other)) add(number);
      }
      if (are_both_zeros(one, other) && !holds(effects, two_strengths)) add(absent(*two_strengths));
    }
  }
  problem.workers.for_each(tried.size(), [&](std::size_t i) {
    auto& [type, start, fitted] = tried[i];
    fitted = fit_together(problem, type, start, search_effects);
    if (fitted && !refutation(problem, *fitted).empty()) fitted.reset();
  });
  std::optional<Candidate> best;
  double highest = both - decisive_gain(problem);
  for (Tried& one : tried) {
    if (!one.fitted) continue;
    const double score = score_of(problem, one.fitted->fit);
    if (score <= highest) continue;
    highest = score;
    best = std::move(one.fitted);
  }
  if (!best) return;
  growth.accept({best->type, softmax({highest + decisive_gain(problem), both}).front()});
  growth.fit = std::move(best->fit);
}

}  // namespace

std::optional<Growth> grown(const IdentificationProblem& problem, const FitOutcome& by_numbers, const Growth& from,
                            const std::vector<Candidate>& beside) {
  const auto next = first_that_earns(problem, by_numbers, from.fit, beside);
  if (!next) return {};
  const auto& [candidate, probability] = *next;
  Growth growth = from;
  growth.fit = candidate->fit;
  growth.accepted.push_back({candidate->type, probability});
  return growth;
}

void grow_further(const IdentificationProblem& problem, const IdentificationProblem& coarse, const Selection& selection,
                  Beside freedom, const PartProgress& progress, Growth& growth) {
  for (std::size_t round = 0;
       growth.fit.effects.size() < tuning::kEffectsMax && gap_energy(problem, growth.fit).is_clear(); ++round) {
    const std::vector<Candidate> beside =
        fit_beside(problem, coarse, growth.fit.effects, freedom, progress.round(round, 3 * tuning::kEffectsMax));
    if (std::optional<Growth> next = grown(problem, selection.by_numbers, growth, beside)) {
      growth = std::move(*next);
      freedom = Beside::as_found;
    } else if (freedom == Beside::as_found) {
      freedom = Beside::numbers_free;
    } else if (freedom == Beside::numbers_free) {
      freedom = Beside::all_giving_way;
    } else {
      break;
    }
  }
}

void correct_numbers(const IdentificationProblem& problem, const FitOutcome& by_numbers, double within,
                     Growth& growth) {
  const std::vector<EffectSetting>& found = growth.fit.effects;
  const GapEnergy left = gap_energy(problem, growth.fit);
  const bool is_at_floor = left.total <= std::pow(tuning::kFaultOverFloor, 2) * left.floor;
  if (found.empty() || is_at_floor || left.is_clear()) return;
  const auto is_new = [&](const EffectSetting& effect) { return !holds(found, effect.type); };
  std::vector<EffectSetting> start = with_all_numbers(problem, found);
  std::erase_if(start, [&](const EffectSetting& effect) {
    return is_new(effect) && effect.type->traits.number == ModelNumber::damping;
  });
  if (start.size() == found.size()) return;
  FitOutcome with = refit_effects(problem, start, false);
  prune(problem, by_numbers, with);
  const auto stays = [&](const EffectSetting& effect) { return holds(with.effects, effect.type); };
  const auto is_slight = [&](const EffectSetting& effect) {
    return !is_new(effect) || changes_at_most(problem, effect, within);
  };
  if (with.effects.size() == found.size() || !std::ranges::all_of(found, stays)) return;
  if (std::ranges::all_of(with.effects, is_slight)) growth.fit = std::move(with);
}

namespace {

/// An effect that earned its place beside those that are left.
bool is_lost(const IdentificationProblem& problem, const FitOutcome& by_numbers, const FitOutcome& left,
             const FitOutcome& before) {
  return std::ranges::any_of(before.effects, [&](const EffectSetting& effect) {
    return !holds(left.effects, effect.type) &&
           earns_its_place(problem, by_numbers, left, {.type = effect.type, .fit = before});
  });
}

/// How many are no numbers of the model.
std::ptrdiff_t count_of_others(const IdentificationProblem& problem, const FitOutcome& fit) {
  return std::ranges::count_if(fit.effects,
                               [&](const EffectSetting& effect) { return !is_number(problem, *effect.type); });
}

/// Whether numbers of the model gave way to effects that are none, without these being decidedly better, and without
/// several others that were far off being slightly off now.
bool numbers_gave_way(const IdentificationProblem& problem, const FitOutcome& left, const FitOutcome& before) {
  if (pushes_numbers(problem, left.effects, before.effects)) return false;
  const std::ptrdiff_t more = count_of_others(problem, left) - count_of_others(problem, before);
  const double gain = score_of(problem, left) - score_of(problem, before);
  return more > 0 && gain < static_cast<double>(more) * decisive_gain(problem);
}

}  // namespace

bool settle(const IdentificationProblem& problem, const IdentificationProblem& coarse, const Selection& selection,
            Growth& growth) {
  const std::size_t count = growth.fit.effects.size();
  // By itself an effect has been compared already, but for a law with what the numbers of the model's own may do.
  if (count == 0 || (count == 1 && growth.fit.effects.front().type->replacement == nullptr)) return false;
  const Growth before = growth;
  growth.fit = refit_effects(coarse, growth.fit.effects, false);
  settle_effects(coarse, selection, growth);
  merge(coarse, growth);
  prune(coarse, refit_effects(coarse, selection.by_numbers.effects, false), growth.fit);
  growth.fit = refit_effects(problem, growth.fit.effects, false);
  // What came in the place of a number may have been better only at the lower rate, or with what was dropped then.
  const bool gave_way = numbers_gave_way(problem, growth.fit, before.fit);
  if (gave_way || is_lost(problem, selection.by_numbers, growth.fit, before.fit)) {
    Growth at_full_rate = before;
    prune(problem, selection.by_numbers, at_full_rate.fit);
    // One effect at a time may go astray there, too.
    const bool is_better = gave_way ? numbers_gave_way(problem, growth.fit, at_full_rate.fit)
                                    : score_of(problem, at_full_rate.fit) > score_of(problem, growth.fit);
    if (is_better) growth = std::move(at_full_rate);
  }
  return growth.fit.effects.size() < count;
}

}  // namespace hybridtest
