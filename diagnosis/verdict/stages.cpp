#include "diagnosis/verdict/stages.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "diagnosis/identification/search.hpp"
#include "diagnosis/identification/segment.hpp"
#include "diagnosis/tuning.hpp"
#include "diagnosis/verdict/growth.hpp"
#include "diagnosis/verdict/rivals.hpp"
#include "diagnosis/verdict/shrink.hpp"
#include "diagnosis/verdict/told_noise.hpp"

namespace hybridtest {

using report::Verdict;

bool Stage::concerns(std::string_view interface) const {
  if (changes_model()) {
    return std::ranges::any_of(selection.chosen.effects, [&](const EffectSetting& effect) {
      return name_of(effect.type->interface) == interface;
    });
  }
  return std::ranges::any_of(problem.segments, [&](const FitSegment& fit) {
    return fit.is_suspect && name_of(fit.segment.interface) == interface;
  });
}

std::vector<EffectSetting> causes_of(std::span<const Stage> stages, std::span<const Trace> traces) {
  std::vector<EffectSetting> causes;
  for (const Stage& stage : stages) {
    if (!stage.changes_model()) continue;
    causes.insert(causes.end(), stage.selection.chosen.effects.begin(), stage.selection.chosen.effects.end());
  }
  std::ranges::transform(traces, std::back_inserter(causes), &Trace::effect);
  return causes;
}

std::vector<Segment> at_suspects(const IdentificationProblem& problem, std::span<const Segment> segments) {
  std::vector<Segment> kept;
  std::ranges::copy_if(segments, std::back_inserter(kept), [&](const Segment& segment) {
    const auto alike = [&](const FitSegment& fit) {
      return fit.segment.from == segment.from && fit.segment.to == segment.to;
    };
    return std::ranges::none_of(problem.segments, alike) ||
           std::ranges::any_of(problem.segments, [&](const FitSegment& fit) { return fit.is_suspect && alike(fit); });
  });
  return kept;
}

void tell_held_out_noise(const SiteModel& completed, const std::vector<Stage>& stages, std::vector<Segment>& held_out) {
  for (const Stage& stage : stages) {
    tell_held_out_noise(stage.problem, stage.selection.chosen, completed, held_out);
  }
}

namespace {

/// Of each kind of segment that the causes act on.
std::vector<report::Shrink> shrinks(const SiteModel& model, std::span<const EffectSetting> causes,
                                    std::span<const Segment> segments, std::span<const FitSegment> fitted,
                                    std::uint64_t seed) {
  std::map<std::pair<Channel, Channel>, std::vector<Segment>> kinds;
  for (const Segment& segment : segments) {
    if (segment.touched_by(causes)) kinds[{segment.from, segment.to}].push_back(segment);
  }
  std::vector<report::Shrink> result;
  for (const auto& [channels, alike] : kinds) result.push_back(shrink_on(model, causes, alike, seed, fitted));
  return result;
}

/// What the causes of all stages leave in held-out recordings, of each kind of segment that they act on.
std::vector<report::Shrink> left_by_all(const SiteModel& model, std::span<const Segment> held_out, std::uint64_t seed,
                                        const std::vector<Stage>& stages, const Stage& stage) {
  const std::vector<EffectSetting> causes = causes_of(stages, {});
  return shrinks(model, causes, at_suspects(stage.problem, held_out), stage.problem.segments, seed);
}

/// Of all kinds of segments together, each by its gap before.
double share_left(std::span<const report::Shrink> held_out) {
  double left = 0.0;
  for (const report::Shrink& one : held_out) left += std::pow(one.nrmse_after / one.nrmse_before, 2);
  return left;
}

/// Chosen without the effect at this position; whether it is a set is not asked again.
void leave_out(const VerdictPolicy& policy, std::size_t position, FitOutcome rest, Stage& stage) {
  Selection& selection = stage.selection;
  const auto at = static_cast<std::ptrdiff_t>(position);
  selection.chosen = std::move(rest);
  selection.chosen_probabilities.erase(selection.chosen_probabilities.begin() + at);
  const double kept = 1.0 - selection.shares[position];
  selection.shares.erase(selection.shares.begin() + at);
  for (double& share : selection.shares)
    share = kept > 0.0 ? share / kept : 1.0 / static_cast<double>(selection.shares.size());
  std::optional<Rivals> rivals = std::move(stage.judgement.rivals);
  stage.judgement = judge(stage.problem, selection, policy);
  if (!rivals || rivals->chosen == position || !stage.has_causes()) return;
  if (rivals->chosen > position) --rivals->chosen;
  stage.judgement.rivals = std::move(rivals);
  if (stage.judgement.may_be_set) stage.judgement.verdict = Verdict::set;
}

/// Whether it is asked if an effect makes a held-out gap larger: not with less than twice the energy of the floor left.
bool may_be_larger(const report::Shrink& held_out) {
  return held_out.nrmse_after > std::numbers::sqrt2 * held_out.floor_nrmse;
}

/// More is left of a held-out recording with an effect than without it, by more than the floor.
bool is_larger_with(std::span<const report::Shrink> with, std::span<const report::Shrink> without) {
  if (with.size() != without.size()) return false;
  for (std::size_t i = 0; i < with.size(); ++i) {
    if (with[i].nrmse_after > std::hypot(without[i].nrmse_after, with[i].floor_nrmse)) return true;
  }
  return false;
}

/// Something that degrades with a quantity that carries over, in the place of what degrades with one that does not:
/// that which predicts the fitted recordings about as well, and is nearest to the held-out ones.
std::optional<FitOutcome> degrading_otherwise(const SiteModel& model, std::span<const Segment> held_out,
                                              std::uint64_t seed, const std::vector<Stage>& stages, Stage& stage,
                                              std::size_t position, double left) {
  const FitOutcome all = stage.selection.chosen;
  std::optional<FitOutcome> nearest;
  if (!degrades(*all.effects[position].type)) return nearest;
  const double enough = score_of(stage.problem, all) - decisive_gain(stage.problem);
  for (const Candidate& candidate : stage.selection.library) {
    const EffectType& type = *candidate.type;
    if (holds(all.effects, &type) || !degrades(type)) continue;
    std::vector<EffectSetting> effects = all.effects;
    effects[position] = candidate.fit.effects.front();
    if (effects[position].type != &type) continue;
    FitOutcome fit = refit_effects(stage.problem, effects, false);
    if (score_of(stage.problem, fit) < enough) continue;
    stage.selection.chosen = fit;
    const std::vector<report::Shrink> shrinks = left_by_all(model, held_out, seed, stages, stage);
    if (std::ranges::any_of(shrinks, is_worse) || share_left(shrinks) >= left) continue;
    left = share_left(shrinks);
    nearest = std::move(fit);
  }
  stage.selection.chosen = all;
  return nearest;
}

/// Of several effects, leaves out those with which a held-out recording is further from the model than without any, or
/// than without that one, the worst first. The others are fitted again to the recordings they were found in.
void leave_out_what_worsens(const SiteModel& model, std::span<const Segment> held_out, std::uint64_t seed,
                            const VerdictPolicy& policy, std::vector<Stage>& stages, Stage& stage,
                            std::vector<std::string>& notes) {
  std::vector<report::Shrink> shrinks = left_by_all(model, held_out, seed, stages, stage);
  const auto is_open = [&] {
    return std::ranges::any_of(shrinks, is_worse) || std::ranges::any_of(shrinks, may_be_larger);
  };
  while (stage.has_causes() && stage.selection.chosen.effects.size() > 1 && is_open()) {
    FitOutcome& chosen = stage.selection.chosen;
    const FitOutcome all = chosen;
    std::size_t worst = 0;
    FitOutcome best;
    std::vector<report::Shrink> least;
    for (std::size_t i = 0; i < all.effects.size(); ++i) {
      chosen = refit_effects(stage.problem, without(all.effects, i), false);
      std::vector<report::Shrink> by_rest = left_by_all(model, held_out, seed, stages, stage);
      if (!least.empty() && share_left(by_rest) >= share_left(least)) continue;
      worst = i;
      best = chosen;
      least = std::move(by_rest);
    }
    chosen = all;
    if (share_left(least) >= share_left(shrinks)) return;
    if (std::ranges::none_of(shrinks, is_worse) && !is_larger_with(shrinks, least)) return;
    if (auto other = degrading_otherwise(model, held_out, seed, stages, stage, worst, share_left(least))) {
      notes.push_back(std::string{other->effects[worst].type->name} + " takes the place of " +
                      std::string{all.effects[worst].type->name} +
                      ": with that, held-out recordings are further from the model than without.");
      stage.selection.chosen = *std::move(other);
      stage.selection.alike.clear();
      stage.judgement = judge(stage.problem, stage.selection, policy);
      shrinks = left_by_all(model, held_out, seed, stages, stage);
      continue;
    }
    notes.push_back(std::string{all.effects[worst].type->name} +
                    " is left out: with it, held-out recordings are further from the model than without.");
    leave_out(policy, worst, std::move(best), stage);
    shrinks = std::move(least);
  }
}

/// Whether the causes of a stage change what is predicted of a held-out recording, beside its corrections and the other
/// stages. Corrections alone are what is asked of.
bool acts_on(const SiteModel& model, std::span<const Segment> held_out, std::uint64_t seed,
             const std::vector<Stage>& stages, const Stage& stage) {
  SiteModel beside = model;
  std::vector<EffectSetting> causes;
  for (const Stage& other : stages) {
    if (!other.changes_model()) continue;
    const std::vector<EffectSetting>& effects = other.selection.chosen.effects;
    for (std::size_t i = 0; i < effects.size(); ++i) {
      const Judgement& judged = stage.judgement;
      const bool is_cause = &other == &stage && (judged.only_corrects || !judged.is_correction(i));
      if (is_cause) {
        causes.push_back(effects[i]);
      } else {
        add_effect(beside, effects[i]);
      }
    }
  }
  return std::ranges::any_of(
      shrinks(beside, causes, at_suspects(stage.problem, held_out), stage.problem.segments, seed), acts);
}

}  // namespace

void drop_what_does_not_carry_over(const SiteModel& model, std::span<const Segment> held_out, std::uint64_t seed,
                                   const VerdictPolicy& policy, std::vector<Stage>& stages,
                                   std::vector<std::string>& notes) {
  for (Stage& stage : stages) {
    if (!stage.has_causes()) continue;
    leave_out_what_worsens(model, held_out, seed, policy, stages, stage, notes);
    if (!stage.has_causes()) continue;
    // Beside the causes of the other stages, so that this one's own part is judged.
    const std::vector<report::Shrink> left = left_by_all(model, held_out, seed, stages, stage);
    Verdict verdict = verdict_carried_over(stage.judgement.verdict, left, policy);
    if (verdict == stage.judgement.verdict) {
      stage.judgement.leaves_a_part = stage.judgement.leaves_a_part || leave_a_part(left, policy);
      continue;
    }
    if (!report::names_a_cause(verdict) && !acts_on(model, held_out, seed, stages, stage)) {
      notes.push_back("The causes at the " + std::string{name_of(stage.problem.segments.front().segment.interface)} +
                      " do not act in the held-out recordings, which therefore do not check them.");
      if (stage.judgement.verdict == Verdict::named) stage.judgement.verdict = Verdict::partial;
      continue;
    }
    // A gap that is clear where it was fitted stays one: with causes that do not hold, noise may be taken for anything.
    if (verdict == Verdict::none && stands_above_floor(stage.problem, stage.selection.baseline, tuning::kNearFloor)) {
      verdict = Verdict::unknown;
    }
    if (verdict == Verdict::partial) {
      notes.push_back(std::string{stage.selection.chosen.effects.front().type->name} +
                      " leaves more of the held-out recordings than of the fitted ones.");
      stage.judgement.verdict = verdict;
      continue;
    }
    notes.push_back(std::string{stage.selection.chosen.effects.front().type->name} +
                    " fits the fitted recordings but not the held-out ones.");
    stage.judgement = Judgement{};
    stage.judgement.verdict = verdict;
    stage.judgement.gap_left = 1.0;
  }
}

namespace {

/// What a channel names of the displacement sensor also changes the channels that were judged before: what was found
/// there is fitted again beside it. Each would explain the same twice, otherwise.
void fit_beside_later(const std::vector<Segment>& segments, const std::vector<Channel>& outputs,
                      std::vector<Stage>& stages) {
  for (std::size_t i = 0; i < stages.size(); ++i) {
    Stage& stage = stages[i];
    if (!stage.changes_model()) continue;
    SiteModel beside = stage.problem.model;
    for (const EffectSetting& effect : causes_of(std::span{stages}.subspan(i + 1), {})) {
      const bool is_seen = std::ranges::any_of(stage.problem.segments, [&](const FitSegment& fit) {
        return fit.is_suspect && fit.segment.touched_by(*effect.type);
      });
      if (is_seen) add_effect(beside, effect);
    }
    if (beside.effects.size() == stage.problem.model.effects.size()) continue;
    IdentificationProblem again = judged_at(make_problem(beside, segments, {}, stage.problem.workers), outputs[i]);
    settle_noise(again, refit_effects(again, stage.selection.chosen.effects, false));
    stage.selection.chosen = refit_effects(again, stage.selection.chosen.effects, false);
  }
}

/// Where damping is named beside a motion that comes late: one lag of the transducer instead of both, if it is a rival.
void find_lag_of_transducer(const IdentificationProblem& whole, const VerdictPolicy& policy,
                            std::vector<Stage>& stages) {
  const EffectType* const damping = find_effect(EffectInterface::specimen, ModelNumber::damping);
  for (Stage& stage : stages) {
    const std::vector<EffectSetting>& effects = stage.selection.chosen.effects;
    const auto found = std::ranges::find(effects, damping, &EffectSetting::type);
    if (!stage.judgement.may_be_set || stage.judgement.rivals || found == effects.end()) continue;
    const auto position = static_cast<std::size_t>(found - effects.begin());
    if (stage.judgement.is_correction(position)) continue;
    std::optional<Candidate> lag = lag_of_transducer(whole, causes_of(stages, {}), policy);
    if (!lag) return;
    stage.judgement.rivals = Rivals{.chosen = position,
                                    .fitted = {std::move(*lag)},
                                    .probability = 0.5 * stage.selection.chosen_probabilities[position]};
    stage.judgement.verdict = Verdict::set;
    return;
  }
}

}  // namespace

std::vector<Stage> judge_stages(const SiteModel& model, std::vector<Segment> segments,
                                const IdentificationProblem& whole, const VerdictPolicy& policy,
                                const PartProgress& progress) {
  const auto at_lower_rate = [&](const SiteModel& completed, std::span<const FoundEffect> found) {
    std::vector<Segment> thin;
    for (const Segment& segment : segments) thin.push_back(thinned(segment, tuning::kFitRate_hz));
    return make_problem(completed, std::move(thin), found, whole.workers);
  };
  IdentificationProblem fine = whole;
  IdentificationProblem coarse = at_lower_rate(model, {});
  std::vector<Channel> outputs;
  for (const Segment& segment : segments) {
    if (std::ranges::find(outputs, segment.to) == outputs.end()) outputs.push_back(segment.to);
  }
  std::ranges::sort(outputs);
  std::vector<Stage> stages;
  std::vector<FoundEffect> found;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    Stage stage{judged_at(fine, outputs[i]), {}, {}};
    IdentificationProblem thinner = judged_at(coarse, outputs[i]);
    const PartProgress of_stage = progress.round(i, outputs.size());
    stage.problem.progress = of_stage;
    thinner.progress = of_stage;
    stage.selection = select_effects(stage.problem, thinner, policy, of_stage.part(0.0, tuning::kEffectsChosen));
    settle_final_noise(stage.problem, stage.selection.chosen);
    stage.judgement = judge(stage.problem, stage.selection, policy);
    find_rivals(stage.problem, thinner, stage.selection, policy, of_stage.part(tuning::kEffectsChosen, 1.0),
                stage.judgement);
    if (i + 1 < outputs.size()) {
      SiteModel corrected = fine.model;
      const FitOutcome& chosen = stage.selection.chosen;
      if (stage.changes_model()) {
        for (const EffectSetting& effect : chosen.effects) add_effect(corrected, effect);
        for (std::size_t j = 0; j < chosen.effects.size(); ++j) {
          found.push_back({chosen.effects[j], chosen.covariances[j]});
        }
      }
      const bool is_noise_told = tell_noise(stage.problem, chosen, corrected, segments);
      if (stage.changes_model() || is_noise_told) {
        fine = make_problem(corrected, segments, found, whole.workers);
        coarse = at_lower_rate(corrected, found);
      }
    }
    stages.push_back(std::move(stage));
  }
  fit_beside_later(segments, outputs, stages);
  find_lag_of_transducer(whole, policy, stages);
  return stages;
}

}  // namespace hybridtest
