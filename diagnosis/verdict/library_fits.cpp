#include "diagnosis/verdict/library_fits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <optional>

#include "core/config_error.hpp"
#include "diagnosis/identification/law_candidates.hpp"
#include "diagnosis/identification/search.hpp"
#include "diagnosis/traces/traces.hpp"
#include "diagnosis/tuning.hpp"
#include "diagnosis/verdict/refutations.hpp"
#include "diagnosis/verdict/typical_recording.hpp"

namespace hybridtest {

double held_out_score(const IdentificationProblem& problem, const FitOutcome& outcome) {
  double score = -outcome.cost_of_numbers;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    const double allowed = 1.0 / (fit.weight * fit.weight);
    double left = outcome.segments[i].left(fit);
    if (fit.is_settled) {
      left = std::max(left, (fit.measured - fit.baseline).squaredNorm() / static_cast<double>(fit.measured.size()));
    }
    score -= 0.5 * fit.predicted_samples() * std::log(left + allowed);
  }
  return score;
}

GapEnergy& GapEnergy::operator+=(const GapEnergy& other) noexcept {
  total += other.total;
  floor += other.floor;
  allowed += other.allowed;
  return *this;
}

bool GapEnergy::is_clear(double energy) const noexcept {
  return energy > tuning::kNearFloor * tuning::kNearFloor * allowed;
}

GapEnergy gap_energy(const FitSegment& segment, const SegmentResult& result) {
  const double variance = segment.measured.squaredNorm() / static_cast<double>(segment.measured.size());
  if (variance <= 0.0) return {};
  return {.total = result.left(segment) / variance,
          .floor = segment.floor * segment.floor / variance,
          .allowed = 1.0 / (segment.weight * segment.weight * variance)};
}

GapEnergy gap_energy(const IdentificationProblem& problem, const FitOutcome& outcome) {
  GapEnergy sum;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    if (!problem.segments[i].is_suspect) continue;
    sum += gap_energy(problem.segments[i], outcome.segments[i]);
  }
  return sum;
}

bool is_of_sensor(const EffectType& effect) noexcept {
  return effect.interface == EffectInterface::displacement_sensor || effect.interface == EffectInterface::force_sensor;
}

namespace {

std::vector<Candidate> best_first(std::vector<std::optional<Candidate>> fitted) {
  std::vector<Candidate> candidates;
  for (std::optional<Candidate>& candidate : fitted) {
    if (candidate && std::isfinite(candidate->score)) candidates.push_back(std::move(*candidate));
  }
  std::ranges::stable_sort(candidates, std::greater{}, &Candidate::score);
  return candidates;
}

/// Of a law with a strength, a stiffness far from that of the model is not a slightly wrong number: together with it a
/// hysteretic element beside the specimen would become another law. A spring has no such law, and the numbers of the
/// user's spring must not decide which effect is found.
bool is_slightly_wrong(const IdentificationProblem& problem, const FitOutcome& fit) {
  if (problem.law_is_spring) return true;
  return std::ranges::none_of(wrong_numbers(problem, fit), [](const EffectSetting& number) {
    return number.type->traits.number == ModelNumber::stiffness && std::abs(number.values[0]) > tuning::kSlightlyWrong;
  });
}

/// Whether a parameter may be left out and this fit is at what it then is; NaN where it has to be given.
bool is_dispensable(double left_out, const SearchRange& range, const ParameterEstimate& estimate) {
  const double off = std::abs(estimate.value - left_out);
  const double resolved = (range.high - range.low) * tuning::kResolution;
  return off <= std::max(half_width_95(estimate), range.scale == ParameterScale::one ? resolved : 0.0);
}

}  // namespace

double free_parameters(const IdentificationProblem& problem, const FitOutcome& fit, std::size_t position) {
  const EffectType& effect = *fit.effects[position].type;
  double free = 0.0;
  for (std::size_t j = 0; j < effect.parameters.size(); ++j) {
    const EffectParameter& parameter = effect.parameters[j];
    if (is_fixed(problem, effect, parameter)) continue;
    const SearchRange range = *range_of(effect, parameter);
    if (!is_dispensable(left_out(problem, effect, j), range, fit.parameters[position][j])) free += 1.0;
  }
  return free;
}

double parameter_cost(const IdentificationProblem& problem) {
  double samples = 0.0;
  for (const FitSegment& fit : problem.segments) {
    if (fit.is_suspect) samples += fit.predicted_samples();
  }
  return std::min(tuning::kParameterPrior, 0.5 * std::log(std::max(1.0, samples)));
}

double prior(const IdentificationProblem& problem, const FitOutcome& fit) {
  const double cost = parameter_cost(problem);
  double sum = 0.0;
  double numbers = 0.0;  // of the specimen's own law, of which each is an effect by name
  for (std::size_t i = 0; i < fit.effects.size(); ++i) {
    const EffectType& effect = *fit.effects[i].type;
    const double free = free_parameters(problem, fit, i);
    if (effect.interface == EffectInterface::specimen && is_model_number(problem, effect)) {
      numbers += free;
      continue;
    }
    sum -= (is_of_sensor(effect) ? tuning::kSensorPrior : 0.0) + cost * std::max(0.0, free - 1.0);
  }
  return sum - cost * std::max(0.0, numbers - 1.0);
}

namespace {

/// Stiffness of the spring beside the effects: the model's, and what a fit adds to it [N/m].
double spring_beside(const IdentificationProblem& problem, const FitOutcome& fit) {
  double stiffness_n_per_m = problem.model.make_law ? problem.model.make_law()->initial_stiffness_n_per_m() : 0.0;
  const double own_n_per_m = stiffness_n_per_m;
  const auto add = [&](const EffectSetting& effect) {
    const bool is_spring = effect.type->traits.number == ModelNumber::stiffness && effect.values.size() > 1;
    if (is_spring) stiffness_n_per_m += effect.values[0] * own_n_per_m + effect.values[1];
  };
  std::ranges::for_each(fit.effects, add);
  if (fit.with_nuisance) std::ranges::for_each(wrong_numbers(problem, fit), add);
  return stiffness_n_per_m;
}

/// Of an effect; 0 where it has no such parameter.
double value_of(const EffectSetting& effect, std::string_view name) {
  const auto found = std::ranges::find(effect.type->parameters, name, &EffectParameter::name);
  const auto position = static_cast<std::size_t>(found - effect.type->parameters.begin());
  return found == effect.type->parameters.end() ? 0.0 : effect.values[position];
}

/// Stops on both sides with hardly any spring left between them, of the model's own and of what is beyond: they are the
/// specimen, beyond a gap, and that is its name.
bool is_gap(const IdentificationProblem& problem, const FitOutcome& fit) {
  if (!problem.law_is_spring || !problem.model.make_law) return false;
  const double own_n_per_m = problem.model.make_law()->initial_stiffness_n_per_m();
  return std::ranges::any_of(fit.effects, [&](const EffectSetting& effect) {
    if (!(value_of(effect, "other_stiffness_ratio") > tuning::kMainShare)) return false;
    const double between_n_per_m = spring_beside(problem, fit);
    const double beyond_n_per_m = between_n_per_m + value_of(effect, "stiffness_n_per_m");
    return between_n_per_m < std::sqrt(tuning::kHardlyLeft) * std::min(own_n_per_m, beyond_n_per_m);
  });
}

/// A friction that slides only after a displacement that is not small, beside a spring: together they are a specimen
/// that yields and hardens, and that is its name; or softens, where a negative spring takes a tenth of the friction and
/// more. Beside another law it has none.
bool is_yielding(const IdentificationProblem& problem, const FitOutcome& fit) {
  if (!problem.law_is_spring || std::ranges::any_of(fit.effects, replaces_law)) return false;
  return std::ranges::any_of(fit.effects, [&](const EffectSetting& effect) {
    const std::ptrdiff_t position = &effect - fit.effects.data();
    if (slides_as_in_model(problem, fit, static_cast<std::size_t>(position))) return false;
    const double presliding_m = value_of(effect, "presliding_displacement_m");
    if (!(presliding_m > tuning::kPreslidingMax * problem.scales.displacement_m)) return false;
    const double spring_n_per_m = spring_beside(problem, fit);
    const double friction_n = value_of(effect, "friction_force_n");
    const double taken_n = -spring_n_per_m * problem.scales.displacement_m;
    return spring_n_per_m > tuning::kHardeningMin * (spring_n_per_m + friction_n / presliding_m) ||
           taken_n > std::sqrt(tuning::kHardlyLeft) * friction_n;
  });
}

/// Beside a spring, a loop that yields after the least displacement of its range, or after less than a dry friction may
/// stick, slides nearly all the way: that is dry friction, and its name. A loop that the model has keeps its own.
bool is_dry_friction(const IdentificationProblem& problem, const FitOutcome& fit) {
  if (!problem.law_is_spring) return false;
  const double peak_m = problem.scales.displacement_m;
  for (std::size_t i = 0; i < fit.effects.size(); ++i) {
    if (place_of(problem.model, *fit.effects[i].type) != nullptr) continue;
    const std::span<const EffectParameter> parameters = fit.effects[i].type->parameters;
    for (std::size_t j = 0; j < parameters.size(); ++j) {
      const bool is_of_loop =
          parameters[j].name == "yield_displacement_m" || parameters[j].name == "hysteretic_displacement_m";
      if (!is_of_loop) continue;
      const ParameterEstimate& yield = fit.parameters[i][j];
      const bool is_least = yield.at_bound && yield.value < tuning::kMainShare * peak_m;
      if (is_least || yield.value < tuning::kPreslidingMax * peak_m) return true;
    }
  }
  return false;
}

void set_score(const IdentificationProblem& problem, Candidate& candidate) {
  candidate.held_out = held_out_score(problem, candidate.fit);
  candidate.score = candidate.held_out + prior(problem, candidate.fit);
  if (candidate.fit.with_nuisance) candidate.score -= tuning::kNuisanceCost;
}

/// The candidate with its score, if it can be the cause.
std::optional<Candidate> scored(const IdentificationProblem& problem, Candidate candidate) {
  const FitOutcome& fit = candidate.fit;
  if (is_yielding(problem, fit) || is_dry_friction(problem, fit) || is_gap(problem, fit)) return {};
  set_score(problem, candidate);
  for (std::size_t i = 0; i < candidate.fit.effects.size(); ++i) {
    candidate.parameters += free_parameters(problem, candidate.fit, i);
  }
  return candidate;
}

/// One effect by itself; a strength beside the stiffness of the same law. What a wrong stiffness changes depends on the
/// strength, so that the change at the model's own strength, a nuisance, does not stand for it. Whether the stiffness
/// is wrong at all is asked at the end.
FitOutcome fit_alone(const IdentificationProblem& problem, const EffectType& effect) {
  if (effect.traits.number != ModelNumber::strength) return fit_effects(problem, {&effect}, false);
  return fit_effects(problem, {&effect, find_effect(EffectInterface::specimen, ModelNumber::stiffness)}, false);
}

std::optional<Candidate> fit_one(const IdentificationProblem& problem, const EffectType& effect,
                                 double nuisance_score) try {
  std::optional<Candidate> alone = scored(problem, {.type = &effect, .fit = fit_alone(problem, effect)});
  // A law has its own stiffness.
  if (effect.replacement != nullptr) return alone;
  FitOutcome with_nuisance = fit_effects(problem, {&effect}, true);
  // An effect must explain something that the nuisance parameters do not.
  const bool is_needed = held_out_score(problem, with_nuisance) > nuisance_score + tuning::kNuisanceCost &&
                         is_slightly_wrong(problem, with_nuisance);
  if (!is_needed) return alone;
  std::optional<Candidate> beside = scored(problem, {.type = &effect, .fit = std::move(with_nuisance)});
  return beside && (!alone || beside->score > alone->score) ? beside : alone;
} catch (const ConfigError&) {
  return {};
}

/// The same fit at the full rate.
std::optional<Candidate> refine(const IdentificationProblem& problem, const Candidate& found) try {
  return scored(problem,
                {.type = found.type, .fit = refit_effects(problem, found.fit.effects, found.fit.with_nuisance)});
} catch (const ConfigError&) {
  return {};
}

}  // namespace

std::optional<Candidate> fit_together(const IdentificationProblem& problem, const EffectType* type,
                                      const std::vector<EffectSetting>& start, decltype(refit_effects)& fit) try {
  return scored(problem, {.type = type, .fit = fit(problem, start, false)});
} catch (const ConfigError&) {
  return {};
}

void fit_each(const Workers& workers, std::size_t count, const std::function<void(std::size_t)>& fit,
              const FitProgress& progress) {
  std::size_t done = 0;
  std::mutex mutex;
  progress(0, count);
  workers.for_each(count, [&](std::size_t i) {
    fit(i);
    const std::scoped_lock lock{mutex};
    progress(++done, count);
  });
}

namespace {

/// Counts the fits of a stage.
FitProgress counted(const PartProgress& progress, std::string_view stage) {
  return [progress, stage](std::size_t done, std::size_t all) { progress.report(stage, done, all); };
}

}  // namespace

namespace {

bool touches_a_gap(const IdentificationProblem& problem, const EffectType& effect) {
  return std::ranges::any_of(problem.segments,
                             [&](const FitSegment& fit) { return fit.is_suspect && fit.segment.touched_by(effect); });
}

/// Whether a fit can change anything: beside some laws every parameter of an effect keeps its fallback.
bool is_searched(const IdentificationProblem& problem, const EffectType& effect) {
  return std::ranges::any_of(effect.parameters,
                             [&](const EffectParameter& parameter) { return !is_fixed(problem, effect, parameter); });
}

/// Positions of effects, those with the most searched parameters first: the longest fits begin first, so that no thread
/// works on one alone at the end.
std::vector<std::size_t> longest_first(const IdentificationProblem& problem,
                                       const std::vector<const EffectType*>& effects) {
  std::vector<std::size_t> order(effects.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater{},
                           [&](std::size_t i) { return plan_search(problem, {effects[i]}).searched.size(); });
  return order;
}

}  // namespace

bool is_number(const IdentificationProblem& problem, const EffectType& type) {
  return is_model_number(problem, type) || type.traits.number == ModelNumber::damping;
}

bool is_of_law(const EffectType& effect) noexcept {
  const ModelNumber number = effect.traits.number;
  return effect.interface == EffectInterface::specimen &&
         (number == ModelNumber::stiffness || number == ModelNumber::strength || number == ModelNumber::hardening);
}

std::vector<EffectSetting> wrong_numbers(const IdentificationProblem& problem, const FitOutcome& fit) {
  std::vector<EffectSetting> numbers;
  std::vector<double> found;
  std::size_t column = 0;
  for (std::size_t i = 0; i < problem.segments.size() && column < fit.nuisance.size(); ++i) {
    if (!fit.segments[i].touched) continue;
    if (!problem.segments[i].is_suspect) {
      column += problem.segments[i].nuisance_types.size();
      continue;
    }
    for (const EffectType* type : problem.segments[i].nuisance_types) {
      auto number = std::ranges::find(numbers, type, &EffectSetting::type);
      if (number == numbers.end()) {
        number = numbers.insert(numbers.end(), absent(*type));
        found.push_back(0.0);
      }
      double& count = found[static_cast<std::size_t>(number - numbers.begin())];
      double& value = number->values[searched_number(problem, *type)];
      value = (value * count + fit.nuisance[column++]) / (count + 1.0);
      count += 1.0;
    }
  }
  return numbers;
}

bool is_judged(const IdentificationProblem& problem, const EffectType& effect) {
  return touches_a_gap(problem, effect) && is_searched(problem, effect);
}

std::vector<const EffectType*> judged_effects(const IdentificationProblem& problem) {
  std::vector<const EffectType*> effects;
  // A specimen that yields is another law, with all its numbers free.
  const EffectType* const part_that_yields = find_effect(EffectInterface::specimen, "yielding");
  // Without a damper in the model it is tried in the place of all that was found: it has something of a dashpot and of
  // dry friction.
  const EffectType* const fluid_damper = find_effect(EffectInterface::specimen, "nonlinear_viscous_damping");
  // Where nothing slides in the model, the law of a friction pendulum has such a friction.
  const EffectType* const growing_friction = find_effect(EffectInterface::specimen, "velocity_strengthening_friction");
  const bool slides = std::ranges::any_of(
      problem.model.effects, [](const EffectSetting& effect) { return presliding_of(*effect.type).has_value(); });
  const auto add = [&](const EffectType& effect) {
    if (is_judged(problem, effect)) effects.push_back(&effect);
  };
  for (const EffectType& effect : effect_library()) {
    if (effect.make == nullptr || shows_in_digits(effect)) continue;
    if (&effect == part_that_yields || (&effect == growing_friction && !slides)) continue;
    if (&effect == fluid_damper && place_of(problem.model, effect) == nullptr) continue;
    if (!effect.traits.takes_input) add(effect);
    for (const InputRange& input : problem.inputs) {
      if (effect.traits.takes_input && input.varies) add(with_input(effect, input.name));
    }
  }
  std::ranges::for_each(problem.model.suspected, [&](const EffectType* formula) { add(*formula); });
  for (const LawCandidate& law : law_candidates(problem.law_is_spring)) {
    if (law.refines == nullptr && !law.is_special && touches_a_gap(problem, law.type)) effects.push_back(&law.type);
  }
  return effects;
}

double decisive_gain(const IdentificationProblem& problem) {
  return std::log(static_cast<double>(std::max<std::size_t>(1, judged_effects(problem).size())) / tuning::kFalseAlarms);
}

namespace {

/// A law that refines a simpler one, from the simpler one's result.
EffectSetting start_from(const LawCandidate& law, const EffectSetting& simpler) {
  EffectSetting start{.type = &law.type, .values = simpler.values};
  start.values.resize(law.type.parameters.size() - law.start.size());
  start.values.insert(start.values.end(), law.start.begin(), law.start.end());
  return start;
}

/// Fits the laws that refine a simpler one while the best candidate leaves something to explain, and a law that leads
/// in the end once more.
void refine_laws(const IdentificationProblem& coarse, std::vector<Candidate>& candidates) {
  const FitOutcome baseline = fit_nothing(coarse, false);
  if (candidates.front().score < held_out_score(coarse, baseline) + decisive_gain(coarse)) return;
  for (const LawCandidate& law : law_candidates(coarse.law_is_spring)) {
    if (law.refines == nullptr) continue;
    const auto simpler = std::ranges::find(candidates, law.refines, &Candidate::type);
    if (simpler == candidates.end()) continue;
    // The form of the law is in question only where a law leads.
    if (candidates.front().type->replacement == nullptr) return;
    if (!gap_energy(coarse, candidates.front().fit).is_clear()) return;
    std::optional<Candidate> found =
        fit_together(coarse, &law.type, {start_from(law, simpler->fit.effects.front())}, refit_effects);
    if (!found) continue;
    // The same law with more of its parameters is no further candidate.
    if (!are_the_same_law(law.type, *law.refines)) {
      candidates.push_back(std::move(*found));
    } else if (found->score > simpler->score) {
      *simpler = std::move(*found);
    }
    std::ranges::stable_sort(candidates, std::greater{}, &Candidate::score);
  }
  const Candidate& leader = candidates.front();
  if (leader.type->replacement == nullptr || !gap_energy(coarse, leader.fit).is_clear()) return;
  std::optional<Candidate> around = fit_together(coarse, leader.type, leader.fit.effects, search_around);
  if (around && around->score > leader.score) candidates.front() = std::move(*around);
}

}  // namespace

namespace {

/// Score of the best candidate that the recordings do not refute by themselves; minus infinity where there is none.
double best_to_believe(const IdentificationProblem& problem, const std::vector<Candidate>& best_first) {
  const auto first = std::ranges::find_if(
      best_first, [&](const Candidate& candidate) { return refutation(problem, candidate).empty(); });
  return first == best_first.end() ? -std::numeric_limits<double>::infinity() : first->score;
}

}  // namespace

std::vector<Candidate> fit_library(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                                   const PartProgress& progress) {
  const std::vector<const EffectType*> effects = judged_effects(problem);
  const double nuisance_score = held_out_score(coarse, fit_nothing(coarse, true));
  std::vector<std::optional<Candidate>> fitted(effects.size());
  const std::vector<std::size_t> order = longest_first(coarse, effects);
  fit_each(
      coarse.workers, effects.size(),
      [&](std::size_t i) { fitted[order[i]] = fit_one(coarse, *effects[order[i]], nuisance_score); },
      counted(progress.part(0.0, tuning::kLibrarySearched), "effects fitted one by one"));
  std::vector<Candidate> candidates = best_first(std::move(fitted));
  if (candidates.empty()) return candidates;
  refine_laws(coarse, candidates);
  // The coarse record has fewer samples: scores are compared with those of the full one relative to no effect.
  const double offset =
      held_out_score(problem, fit_nothing(problem, false)) - held_out_score(coarse, fit_nothing(coarse, false));
  const double best = best_to_believe(coarse, candidates);
  std::vector<std::optional<Candidate>> refined(candidates.size());
  fit_each(
      coarse.workers, candidates.size(),
      [&](std::size_t i) {
        const Candidate& found = candidates[i];
        if (found.score > best - tuning::kFarBehind) {
          refined[i] = refine(problem, found);
        } else {
          refined[i] = found;
          refined[i]->score += offset;
          refined[i]->held_out += offset;
        }
      },
      counted(progress.part(tuning::kLibrarySearched, 1.0), "effects fitted at the full rate"));
  candidates = best_first(std::move(refined));
  drop_refuted(problem, candidates);
  return candidates;
}

namespace {

/// Whether the law is not told by all its parameters: one that cannot be absent is at a limit.
bool is_half_told(const Candidate& law) {
  const std::vector<ParameterEstimate>& estimates = law.fit.parameters.front();
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    if (estimates[i].at_bound && std::isnan(law.type->parameters[i].neutral)) return true;
  }
  return false;
}

}  // namespace

namespace {

/// Searched over its whole range, from what is known of the simpler law that it refines, and around what was found.
std::optional<Candidate> search_law(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                                    const LawCandidate& law, const std::vector<Candidate>& library) {
  std::vector<std::vector<EffectSetting>> starts;
  for (const Candidate& candidate : library) {
    // Where a detailed law did better, it stands in the place of the simpler one.
    const bool is_known = candidate.type == &law.type || (law.refines != nullptr && candidate.type == law.refines);
    if (is_known) starts.push_back({start_from(law, candidate.fit.effects.front())});
  }
  if (law.refines != nullptr) {
    starts.push_back({start_from(law, fit_effects(coarse, {law.refines}, false).effects.front())});
  }
  std::optional<Candidate> best;
  for (const std::vector<EffectSetting>& start : starts) {
    std::optional<Candidate> found =
        fit_together(coarse, &law.type, start, law.refines == nullptr ? refit_effects : search_effects);
    if (!found) continue;
    if (!best || squares_of(coarse, found->fit).fitted < squares_of(coarse, best->fit).fitted) best = std::move(found);
  }
  if (best && law.refines != nullptr) {
    best = fit_together(coarse, &law.type, best->fit.effects, search_around);
  }
  if (!best) return best;
  return fit_together(problem, &law.type, best->fit.effects, refit_effects);
}

}  // namespace

std::vector<Candidate> fit_all_laws(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                                    const std::vector<Candidate>& library) {
  std::vector<const LawCandidate*> laws;
  for (const LawCandidate& law : law_candidates(problem.law_is_spring)) {
    if (!law.is_special && touches_a_gap(problem, law.type)) laws.push_back(&law);
  }
  std::vector<std::optional<Candidate>> fitted(laws.size());
  coarse.workers.for_each(laws.size(), [&](std::size_t i) {
    try {
      fitted[i] = search_law(problem, coarse, *laws[i], library);
    } catch (const ConfigError&) {
      fitted[i].reset();
    }
  });
  std::vector<Candidate> candidates = best_first(std::move(fitted));
  drop_refuted(problem, candidates);
  return candidates;
}

std::vector<Candidate> fit_special_laws(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                                        const PartProgress& progress) {
  std::vector<const EffectType*> laws;
  for (const LawCandidate& law : law_candidates(problem.law_is_spring)) {
    if (law.is_special && touches_a_gap(problem, law.type)) laws.push_back(&law.type);
  }
  std::vector<std::optional<Candidate>> fitted(laws.size());
  fit_each(
      coarse.workers, laws.size(),
      [&](std::size_t i) {
        if (std::optional<Candidate> found = fit_one(coarse, *laws[i], 0.0)) fitted[i] = refine(problem, *found);
      },
      counted(progress, "laws of isolators and dampers"));
  std::vector<Candidate> candidates = best_first(std::move(fitted));
  drop_refuted(problem, candidates);
  std::erase_if(candidates, is_half_told);
  return candidates;
}

bool are_alike(const FitOutcome& first, const FitOutcome& second) {
  if (std::abs(first.cost_of_numbers - second.cost_of_numbers) > tuning::kSensorPrior) return false;
  double both = 0.0;
  double of_first = 0.0;
  double of_second = 0.0;
  for (std::size_t i = 0; i < first.segments.size(); ++i) {
    const Eigen::VectorXd& a = first.segments[i].change;
    const Eigen::VectorXd& b = second.segments[i].change;
    of_first += a.squaredNorm();
    of_second += b.squaredNorm();
    if (a.size() == b.size()) both += a.dot(b);
    // Where the model is far off, everything that mends it has the same shape; what is left tells them apart.
    const double left = first.segments[i].mean_square;
    const double left_by_second = second.segments[i].mean_square;
    if (std::abs(left - left_by_second) > tuning::kSameResidual * std::min(left, left_by_second)) return false;
  }
  return both > tuning::kSameSignature * std::sqrt(of_first * of_second);
}

void put_stage_before_sensor(std::vector<Candidate>& candidates) {
  if (candidates.empty() || !is_of_sensor(*candidates.front().type)) return;
  const auto of_stage = std::ranges::find_if(candidates, [&](const Candidate& candidate) {
    return !is_of_sensor(*candidate.type) && are_alike(candidates.front().fit, candidate.fit);
  });
  if (of_stage != candidates.end()) std::rotate(candidates.begin(), of_stage, of_stage + 1);
}

void score_again(const IdentificationProblem& problem, std::vector<Candidate>& candidates) {
  for (Candidate& candidate : candidates) set_score(problem, candidate);
  std::ranges::stable_sort(candidates, std::greater{}, &Candidate::score);
}

IdentificationProblem beside_effects(const IdentificationProblem& problem, const std::vector<EffectSetting>& effects) {
  IdentificationProblem extended = problem;
  for (const EffectSetting& effect : effects) add_effect(extended.model, effect);
  for (FitSegment& fit : extended.segments) fit.baseline = predict(problem, fit, effects);
  return extended;
}

namespace {

/// What a small step of a parameter changes in a prediction, by its norm; empty where it changes nothing.
Eigen::VectorXd direction_of(const IdentificationProblem& problem, const FitSegment& fit, const Eigen::VectorXd& here,
                             const std::vector<EffectSetting>& effects, std::size_t effect, std::size_t parameter) {
  const EffectType& type = *effects[effect].type;
  if (type.replacement != nullptr) return {};
  const std::optional<SearchRange> range = range_of(type, type.parameters[parameter]);
  if (!range || is_fixed(problem, type, type.parameters[parameter])) return {};
  const double value = effects[effect].values[parameter];
  const double size = problem.scales.of(range->scale) * std::max(std::abs(range->low), std::abs(range->high));
  const double step = tuning::kResolution * (value != 0.0 ? std::abs(value) : size);
  for (const double moved_by : {step, -step}) try {
      std::vector<EffectSetting> moved = effects;
      moved[effect].values[parameter] += moved_by;
      const Eigen::VectorXd change = predict(problem, fit, moved) - here;
      const double norm = change.norm();
      if (norm > 0.0) return change / norm;
    } catch (const ConfigError&) {
      continue;  // a value that the effect does not accept
    }
  return {};
}

/// Frees effects that were found, for small changes: what a fit of them alone took up of another effect shows only
/// where they may give way to it.
void free_nearby(const IdentificationProblem& problem, const std::vector<EffectSetting>& effects,
                 IdentificationProblem& extended) {
  for (FitSegment& fit : extended.segments) {
    for (std::size_t i = 0; i < effects.size(); ++i) {
      const EffectType* const type = effects[i].type;
      const bool is_free = std::ranges::find(fit.nuisance_types, type) != fit.nuisance_types.end();
      if (is_free || !fit.segment.touched_by(*type)) continue;
      for (std::size_t j = 0; j < effects[i].values.size(); ++j) {
        const Eigen::VectorXd direction = direction_of(problem, fit, fit.baseline, effects, i, j);
        if (direction.size() == 0) continue;
        fit.nuisance.conservativeResize(fit.measured.size(), fit.nuisance.cols() + 1);
        fit.nuisance.rightCols(1) = direction;
        fit.nuisance_types.push_back(type);
      }
    }
  }
}

}  // namespace

std::vector<Candidate> fit_beside(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                                  const std::vector<EffectSetting>& base, Beside freedom,
                                  const PartProgress& progress) {
  std::vector<const EffectType*> effects = judged_effects(problem);
  std::erase_if(effects, [&](const EffectType* effect) {
    // Of the laws the simplest stands for all: which one it is, is asked when the effects beside it are known.
    if (effect->replacement != nullptr && effect != &law_candidates(problem.law_is_spring).front().type) return true;
    return std::ranges::any_of(base, [&](const EffectSetting& setting) {
      return setting.type == effect ||
             (setting.type->replacement != nullptr && (effect->replacement != nullptr || is_of_law(*effect)));
    });
  });
  const IdentificationProblem extended = beside_effects(coarse, base);
  const bool are_free = freedom != Beside::as_found;
  IdentificationProblem screen = extended;
  if (freedom == Beside::all_giving_way) free_nearby(coarse, base, screen);
  std::vector<std::optional<Candidate>> screened(effects.size());
  fit_each(
      coarse.workers, effects.size(),
      [&](std::size_t i) {
        try {
          Candidate candidate{.type = effects[i], .fit = fit_effects(screen, {effects[i]}, are_free)};
          candidate.score = held_out_score(screen, candidate.fit);
          screened[i] = std::move(candidate);
        } catch (const ConfigError&) {
          screened[i].reset();
        }
      },
      counted(progress.part(0.0, tuning::kPairsScreened), "further effects screened"));
  std::vector<Candidate> promising = best_first(std::move(screened));
  std::size_t position = 0;
  std::erase_if(promising, [&](const Candidate& candidate) {
    return position++ >= tuning::kRefittedPairs && !is_model_number(problem, *candidate.type);
  });
  std::vector<std::optional<Candidate>> together(promising.size());
  fit_each(
      coarse.workers, promising.size(),
      [&](std::size_t i) {
        try {
          EffectSetting further = promising[i].fit.effects.front();
          // The search begins beside the others as they are.
          if (freedom == Beside::all_giving_way) further = fit_effects(extended, {further.type}, true).effects.front();
          std::vector<EffectSetting> start = base;
          if (further.type->replacement != nullptr) {
            std::erase_if(start, [](const EffectSetting& setting) { return is_of_law(*setting.type); });
          }
          start.push_back(std::move(further));
          together[i] = fit_together(coarse, promising[i].type, start, search_effects);
        } catch (const ConfigError&) {
          together[i].reset();
        }
      },
      counted(progress.part(tuning::kPairsScreened, tuning::kPairsSearched), "effects searched together"));
  // Candidates with a much lower score on the coarse record than one that may be the cause are dropped, and those that
  // are far from being accepted there: the lower rate changes little of what a candidate leaves.
  promising = best_first(std::move(together));
  const double best = best_to_believe(coarse, promising);
  const FitOutcome without = refit_effects(coarse, base, false);
  std::erase_if(promising, [&](const Candidate& candidate) {
    if (candidate.score < best - tuning::kFarBehind) return true;
    if (is_number(problem, *candidate.type))
      return held_out_score(coarse, candidate.fit) < held_out_score(coarse, without);
    return typical(coarse, without, without, candidate).leaves > 0.5 * (1.0 + tuning::kAnotherEffectLeaves);
  });
  std::vector<std::optional<Candidate>> refitted(promising.size());
  fit_each(
      coarse.workers, promising.size(),
      [&](std::size_t i) {
        refitted[i] = fit_together(problem, promising[i].type, promising[i].fit.effects, refit_effects);
      },
      counted(progress.part(tuning::kPairsSearched, 1.0), "effects fitted together at the full rate"));
  std::vector<Candidate> beside = best_first(std::move(refitted));
  drop_refuted(problem, beside);
  return beside;
}

}  // namespace hybridtest
