#include "diagnosis/verdict/library_fits.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <optional>
#include <thread>

#include "core/config_error.hpp"
#include "diagnosis/identification/search.hpp"
#include "diagnosis/identification/search_table.hpp"
#include "diagnosis/traces/traces.hpp"
#include "diagnosis/tuning.hpp"
#include "diagnosis/verdict/refutations.hpp"

namespace hybridtest {

double held_out_score(const IdentificationProblem& problem, const FitOutcome& outcome) {
  double score = 0.0;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    const double allowed = 1.0 / (fit.weight * fit.weight);
    score -= 0.5 * fit.independent * std::log(outcome.segments[i].held_out_mean_square(fit) + allowed);
  }
  return score;
}

GapEnergy gap_energy(const FitSegment& segment, const SegmentResult& result) {
  const double variance = segment.measured.squaredNorm() / static_cast<double>(segment.measured.size());
  if (variance <= 0.0) return {};
  return {.total = result.held_out_mean_square(segment) / variance, .floor = segment.floor * segment.floor / variance};
}

GapEnergy gap_energy(const IdentificationProblem& problem, const FitOutcome& outcome) {
  GapEnergy sum;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    if (!problem.segments[i].is_suspect) continue;
    const GapEnergy one = gap_energy(problem.segments[i], outcome.segments[i]);
    sum.total += one.total;
    sum.floor += one.floor;
  }
  return sum;
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

/// A stiffness far from that of the model is not a slightly wrong number: together with it a hysteretic element beside
/// the specimen would become a yielding specimen, which is another effect.
bool is_slightly_wrong(const IdentificationProblem& problem, const FitOutcome& fit) {
  const EffectType* const stiffness = find_effect(EffectInterface::specimen, ModelNumber::stiffness);
  // A spring beside another one, else the ratio of a law's stiffness.
  const double unit = problem.law_is_spring ? problem.scales.of(ParameterScale::stiffness_n_per_m) : 1.0;
  std::size_t column = 0;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    if (!fit.segments[i].touched) continue;
    for (const EffectType* type : problem.segments[i].nuisance_types) {
      if (type == stiffness && std::abs(fit.nuisance[column]) > tuning::kSlightlyWrong * unit) return false;
      ++column;
    }
  }
  return true;
}

bool is_of_sensor(const EffectType& effect) {
  return effect.interface == EffectInterface::displacement_sensor || effect.interface == EffectInterface::force_sensor;
}

/// Whether a parameter is optional in a scenario and this fit is at its default.
bool is_dispensable(const EffectParameter& parameter, const SearchRange& range, const ParameterEstimate& estimate) {
  const double off = std::abs(estimate.value - parameter.fallback);  // NaN where it has to be given
  const double resolved = (range.high - range.low) * tuning::kRangeUnresolved;
  return off <= std::max(half_width_95(estimate), range.scale == ParameterScale::one ? resolved : 0.0);
}

/// Order of two fits that a recording cannot distinguish: without a sensor effect first, then with fewer
/// parameters.
double prior(const IdentificationProblem& problem, const FitOutcome& fit) {
  double sum = 0.0;
  for (std::size_t i = 0; i < fit.effects.size(); ++i) {
    const EffectType& effect = *fit.effects[i].type;
    double free = 0.0;
    for (std::size_t j = 0; j < effect.parameters.size(); ++j) {
      const EffectParameter& parameter = effect.parameters[j];
      if (is_fixed(problem, effect, parameter)) continue;
      if (!is_dispensable(parameter, *search_range(effect, parameter), fit.parameters[i][j])) free += 1.0;
    }
    sum -= (is_of_sensor(effect) ? tuning::kSensorPrior : 0.0) + tuning::kParameterPrior * std::max(0.0, free - 1.0);
  }
  return sum;
}

std::optional<Candidate> fit_one(const IdentificationProblem& problem, const EffectType& effect,
                                 double nuisance_score) try {
  Candidate alone{.type = &effect, .fit = fit_effects(problem, {&effect}, false)};
  alone.score = held_out_score(problem, alone.fit) + prior(problem, alone.fit);
  Candidate beside{.type = &effect, .fit = fit_effects(problem, {&effect}, true)};
  const double score = held_out_score(problem, beside.fit);
  beside.score = score - tuning::kNuisanceCost + prior(problem, beside.fit);
  // An effect must explain something that the nuisance parameters do not.
  const bool needed = score > nuisance_score + tuning::kNuisanceCost && is_slightly_wrong(problem, beside.fit);
  return needed && beside.score > alone.score ? beside : alone;
} catch (const ConfigError&) {
  return {};
}

/// The same fit at the full rate.
std::optional<Candidate> refine(const IdentificationProblem& problem, const Candidate& found) try {
  Candidate candidate{.type = found.type, .fit = refit_effects(problem, found.fit.effects, found.fit.with_nuisance)};
  candidate.score = held_out_score(problem, candidate.fit) + prior(problem, candidate.fit) -
                    (found.fit.with_nuisance ? tuning::kNuisanceCost : 0.0);
  return candidate;
} catch (const ConfigError&) {
  return {};
}

/// Effects fitted together, the one in question told by its type.
std::optional<Candidate> fit_together(const IdentificationProblem& problem, const EffectType* type,
                                      const std::vector<EffectSetting>& start, decltype(refit_effects)& fit) try {
  Candidate candidate{.type = type, .fit = fit(problem, start, false)};
  candidate.score = held_out_score(problem, candidate.fit) + prior(problem, candidate.fit);
  return candidate;
} catch (const ConfigError&) {
  return {};
}

}  // namespace

void for_each_in_parallel(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& work,
                          const FitProgress& progress) {
  std::atomic<std::size_t> next = 0;
  std::size_t done = 0;
  std::mutex mutex;
  progress(0, count);
  const auto run = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      work(i);
      const std::scoped_lock lock{mutex};
      progress(++done, count);
    }
  };
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < std::min(threads, count); ++i) others.emplace_back(run);
  run();
}

namespace {

/// Counts the fits of a stage.
FitProgress counted(const PartProgress& progress, std::string_view stage) {
  return [progress, stage](std::size_t done, std::size_t all) { progress.report(stage, done, all); };
}

}  // namespace

std::vector<const EffectType*> judged_effects(const IdentificationProblem& problem) {
  std::vector<const EffectType*> effects;
  for (const EffectType& effect : effect_library()) {
    const bool touches =
        std::ranges::any_of(problem.segments, [&](const FitSegment& fit) { return fit.segment.touched_by(effect); });
    if (touches && effect.make != nullptr && !shows_in_digits(effect)) effects.push_back(&effect);
  }
  return effects;
}

std::vector<Candidate> fit_library(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                                   std::size_t threads, const PartProgress& progress) {
  const std::vector<const EffectType*> effects = judged_effects(problem);
  const double nuisance_score = held_out_score(coarse, fit_nothing(coarse, true));
  std::vector<std::optional<Candidate>> fitted(effects.size());
  for_each_in_parallel(
      effects.size(), threads, [&](std::size_t i) { fitted[i] = fit_one(coarse, *effects[i], nuisance_score); },
      counted(progress.part(0.0, tuning::kLibrarySearched), "effects fitted one by one"));
  std::vector<Candidate> candidates = best_first(std::move(fitted));
  if (candidates.empty()) return candidates;
  // The coarse record has fewer samples: scores are compared with those of the full one relative to no effect.
  const double offset =
      held_out_score(problem, fit_nothing(problem, false)) - held_out_score(coarse, fit_nothing(coarse, false));
  const double best = candidates.front().score;
  std::vector<std::optional<Candidate>> refined(candidates.size());
  for_each_in_parallel(
      candidates.size(), threads,
      [&](std::size_t i) {
        const Candidate& found = candidates[i];
        if (found.score > best - tuning::kFarBehind) {
          refined[i] = refine(problem, found);
        } else {
          refined[i] = found;
          refined[i]->score += offset;
        }
      },
      counted(progress.part(tuning::kLibrarySearched, 1.0), "effects fitted at the full rate"));
  candidates = best_first(std::move(refined));
  drop_refuted(problem, candidates);
  return candidates;
}

std::vector<Candidate> fit_beside(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                                  const std::vector<EffectSetting>& base, std::size_t threads,
                                  const PartProgress& progress) {
  std::vector<const EffectType*> effects = judged_effects(problem);
  std::erase_if(effects, [&](const EffectType* effect) {
    return std::ranges::any_of(base, [&](const EffectSetting& setting) { return setting.type == effect; });
  });
  IdentificationProblem extended = coarse;
  extended.model.effects.insert(extended.model.effects.end(), base.begin(), base.end());
  for (FitSegment& fit : extended.segments) fit.baseline = predict(coarse, fit, base);
  std::vector<std::optional<Candidate>> screened(effects.size());
  for_each_in_parallel(
      effects.size(), threads,
      [&](std::size_t i) {
        try {
          Candidate candidate{.type = effects[i], .fit = fit_effects(extended, {effects[i]}, false)};
          candidate.score = held_out_score(extended, candidate.fit);
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
  for_each_in_parallel(
      promising.size(), threads,
      [&](std::size_t i) {
        std::vector<EffectSetting> start = base;
        start.push_back(promising[i].fit.effects.front());
        together[i] = fit_together(coarse, promising[i].type, start, search_effects);
      },
      counted(progress.part(tuning::kPairsScreened, tuning::kPairsSearched), "effects searched together"));
  // Candidates with a much lower score on the coarse record are dropped.
  promising = best_first(std::move(together));
  std::erase_if(promising, [best = promising.empty() ? 0.0 : promising.front().score](const Candidate& candidate) {
    return candidate.score < best - tuning::kFarBehind;
  });
  std::vector<std::optional<Candidate>> refitted(promising.size());
  for_each_in_parallel(
      promising.size(), threads,
      [&](std::size_t i) {
        refitted[i] = fit_together(problem, promising[i].type, promising[i].fit.effects, refit_effects);
      },
      counted(progress.part(tuning::kPairsSearched, 1.0), "effects fitted together at the full rate"));
  std::vector<Candidate> beside = best_first(std::move(refitted));
  drop_refuted(problem, beside);
  return beside;
}

}  // namespace hybridtest
