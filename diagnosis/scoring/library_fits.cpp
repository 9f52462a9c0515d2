#include "diagnosis/scoring/library_fits.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <optional>
#include <thread>

#include "core/config/error.hpp"
#include "diagnosis/scoring/score.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

/// A random effect leaves no path that a fit could follow.
bool is_random(const EffectType& effect) {
  return std::ranges::any_of(effect.parameters,
                             [](const EffectParameter& parameter) { return parameter.name == "seed"; });
}

std::vector<Candidate> best_first(std::vector<std::optional<Candidate>> fitted) {
  std::vector<Candidate> candidates;
  for (std::optional<Candidate>& candidate : fitted) {
    if (candidate && std::isfinite(candidate->score)) candidates.push_back(std::move(*candidate));
  }
  std::ranges::stable_sort(candidates, std::greater{}, &Candidate::score);
  return candidates;
}

std::optional<Candidate> fit_one(const IdentificationProblem& problem, const EffectType& effect,
                                 double nuisance_score) try {
  Candidate alone{.type = &effect, .fit = fit_effects(problem, {&effect}, false)};
  alone.score = held_out_score(problem, alone.fit);
  Candidate beside{.type = &effect, .fit = fit_effects(problem, {&effect}, true)};
  const double score = held_out_score(problem, beside.fit);
  beside.score = score - tuning::kNuisanceCost;
  // Beside the nuisances an effect has to explain something that they do not.
  const bool needed = score > nuisance_score + tuning::kNuisanceCost;
  return needed && beside.score > alone.score ? beside : alone;
} catch (const ConfigError&) {
  return {};
}

}  // namespace

void for_each_in_parallel(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& work,
                          const FitProgress& progress) {
  std::atomic<std::size_t> next = 0;
  std::size_t done = 0;
  std::mutex mutex;
  const auto run = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      work(i);
      const std::scoped_lock lock{mutex};
      if (progress) progress(++done, count);
    }
  };
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < std::min(threads, count); ++i) others.emplace_back(run);
  run();
}

std::vector<const EffectType*> judged_effects(const IdentificationProblem& problem) {
  std::vector<const EffectType*> effects;
  for (const EffectType& effect : effect_library()) {
    const bool touches =
        std::ranges::any_of(problem.segments, [&](const FitSegment& fit) { return fit.segment.touched_by(effect); });
    if (touches && effect.make != nullptr && !is_random(effect)) effects.push_back(&effect);
  }
  return effects;
}

std::vector<Candidate> fit_library(const IdentificationProblem& problem, std::size_t threads,
                                   const FitProgress& progress) {
  const std::vector<const EffectType*> effects = judged_effects(problem);
  const double nuisance_score = held_out_score(problem, fit_nothing(problem, true));
  std::vector<std::optional<Candidate>> fitted(effects.size());
  for_each_in_parallel(
      effects.size(), threads, [&](std::size_t i) { fitted[i] = fit_one(problem, *effects[i], nuisance_score); },
      progress);
  return best_first(std::move(fitted));
}

std::vector<Candidate> fit_beside(const IdentificationProblem& problem, const std::vector<EffectSetting>& base,
                                  std::size_t threads) {
  std::vector<const EffectType*> effects = judged_effects(problem);
  std::erase_if(effects, [&](const EffectType* effect) {
    return std::ranges::any_of(base, [&](const EffectSetting& setting) { return setting.type == effect; });
  });
  IdentificationProblem extended = problem;
  extended.model.effects.insert(extended.model.effects.end(), base.begin(), base.end());
  for (FitSegment& fit : extended.segments) fit.baseline = predict(problem, fit, base);
  std::vector<std::optional<Candidate>> screened(effects.size());
  for_each_in_parallel(effects.size(), threads, [&](std::size_t i) {
    try {
      Candidate candidate{.type = effects[i], .fit = fit_effects(extended, {effects[i]}, false)};
      candidate.score = held_out_score(extended, candidate.fit);
      screened[i] = std::move(candidate);
    } catch (const ConfigError&) {
      screened[i].reset();
    }
  });
  std::vector<Candidate> promising = best_first(std::move(screened));
  promising.resize(std::min(promising.size(), tuning::kRefittedPairs));
  std::vector<std::optional<Candidate>> refitted(promising.size());
  for_each_in_parallel(promising.size(), threads, [&](std::size_t i) {
    std::vector<EffectSetting> start = base;
    start.push_back(promising[i].fit.effects.front());
    try {
      Candidate candidate{.type = promising[i].type, .fit = refit_effects(problem, start, false)};
      candidate.score = held_out_score(problem, candidate.fit);
      refitted[i] = std::move(candidate);
    } catch (const ConfigError&) {
      refitted[i].reset();
    }
  });
  return best_first(std::move(refitted));
}

}  // namespace hybridtest
