#include "diagnosis/verdict/selection.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/identification/search.hpp"
#include "diagnosis/tuning.hpp"
#include "diagnosis/verdict/cause_shares.hpp"
#include "diagnosis/verdict/leaders.hpp"
#include "diagnosis/verdict/others_in_place.hpp"
#include "diagnosis/verdict/refutations.hpp"

namespace hybridtest {

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

/// The model with its numbers free, and damping: what is left is for other effects.
FitOutcome fit_numbers(const IdentificationProblem& problem, const IdentificationProblem& coarse) {
  return refit_effects(problem, search_effects(coarse, numbers_of(coarse), false).effects, false);
}

/// The effects that are found from the leaders of the library on.
Growth grow_from_library(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                         Selection& selection, const PartProgress& progress) {
  Growth growth = best_start(problem, coarse, selection, progress.part(tuning::kLibraryFitted, tuning::kPairsFitted));
  const PartProgress further = progress.part(tuning::kPairsFitted, tuning::kEffectsChosen);
  // Beside a leader alone nothing was accepted.
  const Beside freedom = growth.accepted.size() > 1 ? Beside::as_found : Beside::numbers_free;
  grow_further(problem, coarse, selection, freedom, further, growth);
  // In place of what was dropped, something else may be needed.
  if (settle(problem, coarse, selection, growth)) {
    grow_further(problem, coarse, selection, Beside::as_found, further, growth);
    settle(problem, coarse, selection, growth);
  }
  return growth;
}

/// The effects that explain the gap, from the library as it stands; none where its best is not decidedly better.
Growth find_effects(const IdentificationProblem& problem, const IdentificationProblem& coarse, Selection& selection,
                    const PartProgress& progress) {
  if (selection.library.empty() ||
      selection.library.front().score < held_out_score(problem, selection.baseline) + decisive_gain(problem)) {
    return {.fit = selection.baseline, .accepted = {}};
  }
  return grow_from_library(problem, coarse, selection, progress);
}

/// The noise is known better beside what was found than it was beside the best effect by itself. Where the floor was
/// too high for that, what it hid is looked for.
void look_again(IdentificationProblem& problem, IdentificationProblem& coarse, Selection& selection,
                const PartProgress& progress, Growth& growth) {
  if (growth.fit.effects.empty() || gap_energy(problem, growth.fit).is_clear()) return;
  IdentificationProblem settled = problem;
  settle_noise(settled, growth.fit);
  if (!gap_energy(settled, growth.fit).is_clear()) return;
  problem = std::move(settled);
  settle_noise(coarse, refit_effects(coarse, growth.fit.effects, false));
  growth.fit = refit_effects(problem, growth.fit.effects, false);
  score_again(problem, selection.library);
  grow_further(problem, coarse, selection, Beside::as_found, progress, growth);
  settle(problem, coarse, selection, growth);
}

bool has_law_without_loop(const IdentificationProblem& problem, const FitOutcome& fit) {
  for (std::size_t i = 0; i < fit.effects.size(); ++i) {
    if (is_law_without_loop(problem, fit, i)) return true;
  }
  return false;
}

/// The same without the law that was found, and without any other that has no loop.
Selection without_such_laws(const IdentificationProblem& problem, const FitOutcome& found, Selection selection) {
  std::erase_if(selection.library, [&](const Candidate& candidate) {
    const bool is_found_law = candidate.type->replacement != nullptr && holds(found.effects, candidate.type);
    return is_found_law || has_law_without_loop(problem, candidate.fit);
  });
  selection.alike.clear();
  weigh(selection.library, scores_of(selection.library));
  return selection;
}

/// Where a law without a loop was found, the search again without it: a load cell that gives way at its limit bends the
/// force just so. The law stays where nothing else comes near what it explains.
void doubt_law_without_loop(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                            Selection& selection, const PartProgress& progress, Growth& growth) {
  if (!has_law_without_loop(problem, growth.fit)) return;
  Selection rest = without_such_laws(problem, growth.fit, selection);
  Growth other = find_effects(problem, coarse, rest, progress);
  const double gap = gap_energy(problem, selection.by_numbers).excess();
  const GapEnergy left_by_law = gap_energy(problem, growth.fit);
  const GapEnergy left = gap_energy(problem, other.fit);
  const bool law_explains = !left_by_law.is_clear() || left_by_law.excess() <= tuning::kHardlyLeft * gap;
  if (law_explains && left.is_clear() && left.excess() > tuning::kAnotherEffectExplains * gap) return;
  selection = std::move(rest);
  growth = std::move(other);
}

/// A law or a damper in the place of all that was found.
void put_in_place(Candidate law, double probability, Selection& selection, Growth& growth) {
  growth = {.fit = law.fit, .accepted = {{law.type, probability}}};
  std::erase_if(selection.library, [&](const Candidate& candidate) { return candidate.type == law.type; });
  for (Candidate& other : selection.library) other.probability *= 1.0 - probability;
  law.probability = probability;
  selection.library.insert(selection.library.begin(), std::move(law));
  selection.alike.clear();
}

/// Whether a law was found and another effect of the specimen beside it.
bool is_law_with_another(const FitOutcome& fit) {
  const auto is_another = [&](const EffectSetting& effect) {
    return !replaces_law(effect) && effect.type->interface == EffectInterface::specimen;
  };
  return std::ranges::any_of(fit.effects, replaces_law) && std::ranges::any_of(fit.effects, is_another);
}

/// Where what was found leaves something to explain: the law of a special device instead, if it is decidedly better by
/// itself. Nothing is looked for beside it: what it leaves is told as left. Where a law and another effect explain it
/// together, as a hysteresis and a damper: the device that is both, if it is better.
void try_special_laws(const IdentificationProblem& problem, const IdentificationProblem& coarse, Selection& selection,
                      const PartProgress& progress, Growth& growth) {
  const bool is_left = gap_energy(problem, growth.fit).is_clear();
  if (!is_left && !is_law_with_another(growth.fit)) return;
  std::vector<Candidate> laws = fit_special_laws(problem, coarse, progress);
  const double before = score_of(problem, growth.fit);
  if (laws.empty() || laws.front().score <= before + (is_left ? decisive_gain(problem) : 0.0)) return;
  std::vector<double> scores = scores_of(laws);
  scores.push_back(before);
  const double probability = softmax(scores).front();
  put_in_place(std::move(laws.front()), probability, selection, growth);
}

/// A fluid damper with the numbers of the model that it needs; none where it may as well be something simpler, or where
/// it predicts no better at the lower rate than what was found.
std::optional<Candidate> fit_fluid_damper(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                                          const Selection& selection, const Growth& growth) {
  const EffectType* const type = find_effect(EffectInterface::specimen, "nonlinear_viscous_damping");
  if (place_of(problem.model, *type) != nullptr || !is_judged(problem, *type)) return {};
  std::vector<EffectSetting> start{{type, {0.0, 1.0, 0.0}}};
  for (EffectSetting& number : numbers_of(problem)) start.push_back(std::move(number));
  const std::optional<Candidate> found = fit_together(coarse, type, start, search_effects);
  if (!found || found->held_out <= held_out_score(coarse, refit_effects(coarse, growth.fit.effects, false))) return {};
  FitOutcome needed = refit_effects(problem, found->fit.effects, false);
  prune(problem, selection.by_numbers, needed);
  if (!holds(needed.effects, type)) return {};
  std::optional<Candidate> damper = fit_together(problem, type, needed.effects, refit_effects);
  if (damper && !refutation(problem, *damper).empty()) damper.reset();
  return damper;
}

/// Where what was found leaves something to explain: a fluid damper instead, if it is decidedly better. Nothing is
/// looked for beside it. A power of the velocity has something of a dashpot and of dry friction: before the others are
/// known, only one beside a spring that leaves nothing is believed.
void try_fluid_damper(const IdentificationProblem& problem, const IdentificationProblem& coarse, bool all_are_known,
                      Selection& selection, Growth& growth) {
  if (!gap_energy(problem, growth.fit).is_clear() || !(all_are_known || problem.law_is_spring)) return;
  std::optional<Candidate> damper = fit_fluid_damper(problem, coarse, selection, growth);
  if (!damper || (!all_are_known && gap_energy(problem, damper->fit).is_clear())) return;
  const double before = score_of(problem, growth.fit);
  if (damper->score <= before + decisive_gain(problem)) return;
  const double probability = softmax({damper->score, before}).front();
  put_in_place(*std::move(damper), probability, selection, growth);
}

/// Whether effects beside the model's law make another one of it: they go with the amplitude, or with what the specimen
/// went through.
bool bends_the_law(const IdentificationProblem& problem, const FitOutcome& fit) {
  const auto bends = [&](const EffectSetting& effect) {
    const EffectFamily family = effect.type->traits.family;
    const bool is_of_history = family == EffectFamily::amplitude || family == EffectFamily::degradation;
    return effect.type->interface == EffectInterface::specimen && is_of_history && !is_number(problem, *effect.type);
  };
  return std::ranges::none_of(fit.effects, replaces_law) && std::ranges::any_of(fit.effects, bends);
}

/// Where what was found leaves more than a part allows: the best law of those that leave a part at most, and predict
/// better than what was found. Under a large gap that no simple law explains, few samples count as independent of each
/// other, and the numbers of a detailed law cost more than it can gain: what it leaves of blocks that were left out
/// tells more. Where it leaves less, and bends the law: the best one that is decidedly better. Nothing is looked for
/// beside it.
void try_all_laws(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                  const VerdictPolicy& policy, Selection& selection, Growth& growth) {
  const GapEnergy left = gap_energy(problem, growth.fit);
  const double part = policy.partial_leaves * gap_energy(problem, selection.by_numbers).excess();
  const bool is_too_much = left.excess() > part;
  if (!left.is_clear() || !(is_too_much || bends_the_law(problem, growth.fit))) return;
  std::vector<Candidate> laws = fit_all_laws(problem, coarse, selection.library);
  const double before = is_too_much ? std::max(held_out_score(problem, growth.fit),
                                               held_out_score(problem, selection.baseline) + decisive_gain(problem))
                                    : score_of(problem, growth.fit) + decisive_gain(problem);
  std::erase_if(laws, [&](const Candidate& law) {
    return (is_too_much ? law.held_out : law.score) <= before || gap_energy(problem, law.fit).excess() > part;
  });
  if (laws.empty()) return;
  const double probability = softmax(scores_of(laws)).front();
  put_in_place(std::move(laws.front()), probability, selection, growth);
}

/// Where nothing explains a clear gap by itself, several effects may do it together: each of them has to be decidedly
/// better than none, so that none is taken for what it does beside the others.
void try_several(const IdentificationProblem& problem, const IdentificationProblem& coarse, Selection& selection,
                 const PartProgress& progress, Growth& growth) {
  const bool is_unknown = growth.fit.effects.empty() && !selection.library.empty();
  if (!is_unknown || !stands_above_floor(problem, selection.baseline, tuning::kNearFloor)) return;
  Selection together = selection;
  Growth several = grow_from_library(problem, coarse, together, progress);
  const auto count = static_cast<double>(several.fit.effects.size());
  const double before = held_out_score(problem, selection.baseline);
  if (count < 2.0 || score_of(problem, several.fit) < before + count * decisive_gain(problem)) return;
  selection = std::move(together);
  growth = std::move(several);
}

/// Numbers of the model are expected to be off: where nothing is decidedly better than none, those that are slightly
/// off are corrected if they predict better and leave no clear gap beside the noise that they show. Under slow noise
/// few samples count, and none decides.
void try_slight_numbers(IdentificationProblem& problem, IdentificationProblem& coarse, const VerdictPolicy& policy,
                        Selection& selection, Growth& growth) {
  if (!growth.fit.effects.empty() || !gap_energy(problem, selection.baseline).is_clear()) return;
  std::vector<EffectSetting> numbers = selection.by_numbers.effects;
  std::erase_if(numbers, [](const EffectSetting& number) {
    return number.type->traits.number == ModelNumber::damping || number.type->traits.number == ModelNumber::offset;
  });
  if (numbers.empty()) return;
  IdentificationProblem settled = problem;
  settle_noise(settled, refit_effects(settled, numbers, false));
  FitOutcome fit = refit_effects(settled, numbers, false);
  const auto is_slight = [&](const EffectSetting& number) {
    return changes_at_most(settled, number, policy.numbers_within);
  };
  if (!std::ranges::all_of(fit.effects, is_slight) || gap_energy(settled, fit).is_clear()) return;
  FitOutcome nothing = fit_nothing(settled, false);
  if (held_out_score(settled, fit) <= held_out_score(settled, nothing)) return;
  problem = std::move(settled);
  settle_noise(coarse, refit_effects(coarse, fit.effects, false));
  selection.baseline = std::move(nothing);
  growth.fit = std::move(fit);
}

/// What the numbers of the model leave. Damping counts only where it was found beside the effects: elsewhere an effect
/// stands in its place, by its score, and damping alone is the worse answer.
GapEnergy left_by_numbers(const IdentificationProblem& problem, const Selection& selection, const FitOutcome& found) {
  const FitOutcome& all = selection.by_numbers;
  std::vector<EffectSetting> numbers = all.effects;
  std::erase_if(numbers, [&](const EffectSetting& number) {
    return number.type->traits.number == ModelNumber::damping && !holds(found.effects, number.type);
  });
  if (numbers.size() == all.effects.size()) return gap_energy(problem, all);
  return gap_energy(problem, numbers.empty() ? selection.baseline : refit_effects(problem, numbers, false));
}

/// Effects that leave more of what the numbers of the model leave than a part allows, and more than the floor, are
/// dropped: that the numbers are far off is no reason to believe what stands beside them. An effect of the displacement
/// sensor is chosen by what it explains of the force, too, and stays.
void keep_what_tells(const IdentificationProblem& problem, const VerdictPolicy& policy, const Selection& selection,
                     Growth& growth) {
  const auto is_effect = [&](const EffectSetting& effect) { return !is_number(problem, *effect.type); };
  const auto shows_in_the_force = [](const EffectSetting& effect) {
    return effect.type->interface == EffectInterface::displacement_sensor;
  };
  const std::vector<EffectSetting>& effects = growth.fit.effects;
  const GapEnergy left = gap_energy(problem, growth.fit);
  if (!left.is_clear() || std::ranges::none_of(effects, is_effect)) return;
  if (std::ranges::any_of(effects, shows_in_the_force)) return;
  if (left.excess() <= policy.partial_leaves * left_by_numbers(problem, selection, growth.fit).excess()) return;
  if (std::optional<FitOutcome> numbers = needed_numbers(problem, selection)) growth.fit = std::move(*numbers);
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
  if (!left.empty() && left.size() < fit.effects.size()) fit = refit_effects(problem, left, false);
  for (std::size_t i = fit.effects.size(); i-- > 0 && fit.effects.size() > 1;) {
    if (!may_be_absent(problem, fit, i)) continue;
    FitOutcome rest = refit_effects(problem, without(fit.effects, i), false);
    const double lost = held_out_score(problem, fit) - held_out_score(problem, rest);
    if (lost < tuning::kParameterPrior) fit = std::move(rest);
  }
}

Selection select_effects(IdentificationProblem& problem, IdentificationProblem& coarse, const VerdictPolicy& policy,
                         const PartProgress& progress) {
  Selection selection;
  selection.baseline = fit_nothing(problem, false);
  selection.chosen = selection.baseline;
  if (!stands_above_floor(problem, selection.baseline, tuning::kGapOverFloor)) return selection;
  // The numbers that the user gave do not decide which noise the candidates are compared by.
  selection.by_numbers = fit_numbers(problem, coarse);
  settle_noise(problem, selection.by_numbers);
  settle_noise(coarse, refit_effects(coarse, selection.by_numbers.effects, false));
  selection.library = fit_library(problem, coarse, progress.part(0.0, tuning::kLibraryFitted));
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
  weigh(selection.library, scores_of(selection.library));
  Growth growth{.fit = selection.library.front().fit, .accepted = {}};
  try_fluid_damper(problem, coarse, false, selection, growth);
  if (growth.accepted.empty()) growth = find_effects(problem, coarse, selection, progress);
  doubt_law_without_loop(problem, coarse, selection, progress, growth);
  look_again(problem, coarse, selection, progress.part(tuning::kPairsFitted, tuning::kEffectsChosen), growth);
  try_special_laws(problem, coarse, selection, progress.part(tuning::kPairsFitted, tuning::kEffectsChosen), growth);
  try_fluid_damper(problem, coarse, true, selection, growth);
  try_all_laws(problem, coarse, policy, selection, growth);
  try_several(problem, coarse, selection, progress, growth);
  try_slight_numbers(problem, coarse, policy, selection, growth);
  keep_what_tells(problem, policy, selection, growth);
  correct_numbers(problem, selection.by_numbers, policy.numbers_within, growth);
  if (growth.fit.effects.empty()) return selection;
  // Of what was chosen at the lower rate, the full rate may leave nothing.
  drop_gone(problem, growth.fit);
  selection.shares = cause_shares(coarse, growth.fit.effects, progress.part(tuning::kEffectsChosen, 1.0));
  selection.chosen = std::move(growth.fit);
  for (const EffectSetting& effect : selection.chosen.effects) {
    selection.chosen_probabilities.push_back(growth.probability_of(effect.type));
  }
  put_others_beside(problem, policy, growth, selection);
  return selection;
}

}  // namespace hybridtest
