#include "diagnosis/verdict/rivals.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/config_error.hpp"
#include "diagnosis/identification/law_candidates.hpp"
#include "diagnosis/tuning.hpp"
#include "diagnosis/verdict/growth.hpp"
#include "diagnosis/verdict/held_out_loss.hpp"
#include "diagnosis/verdict/refutations.hpp"

namespace hybridtest {

namespace {

/// Changes of the baseline in the suspect segments, weighted and one behind the other.
template <class ChangeOf>
Eigen::VectorXd stacked_changes(const IdentificationProblem& problem, ChangeOf&& change_of) {
  Eigen::VectorXd all;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    if (!fit.is_suspect) continue;
    all.conservativeResize(all.size() + fit.baseline.size());
    all.tail(fit.baseline.size()).setZero();
    const Eigen::VectorXd change = change_of(i);
    if (change.size() > 0) all.tail(fit.baseline.size()) = fit.weight * change;
  }
  return all;
}

Eigen::VectorXd changes_by(const IdentificationProblem& problem, std::span<const EffectSetting> effects) {
  return stacked_changes(problem, [&](std::size_t i) -> Eigen::VectorXd {
    return predict(problem, problem.segments[i], effects) - problem.segments[i].baseline;
  });
}

/// Its free numbers of the model included.
Eigen::VectorXd changes_of(const IdentificationProblem& problem, const FitOutcome& fit) {
  return stacked_changes(problem, [&](std::size_t i) { return fit.segments[i].change; });
}

/// Of a difference, against what an effect changes.
bool is_small(const Eigen::VectorXd& difference, const Eigen::VectorXd& change) {
  return difference.norm() <= std::sqrt(1.0 - tuning::kSameSignature * tuning::kSameSignature) * change.norm();
}

/// A difference that hardly matters, though it may be told.
bool is_slight(const Eigen::VectorXd& difference, const Eigen::VectorXd& change) {
  return difference.squaredNorm() <= tuning::kHardlyLeft * change.squaredNorm();
}

/// Of a fit at the lower rate whose numbers are free for small changes only: no more than what a further effect has to
/// explain.
bool may_be_slight(const Eigen::VectorXd& difference, const Eigen::VectorXd& change) {
  return difference.squaredNorm() <= tuning::kAnotherEffectExplains * change.squaredNorm();
}

/// What a chosen effect changes beside the others.
struct Place {
  const FitOutcome* chosen = nullptr;
  std::size_t position = 0;           // of the effect in it
  std::vector<EffectSetting> others;  // but for numbers of which a rival may need other values
  Eigen::VectorXd all;                // changes by everything that was chosen
  Eigen::VectorXd alone;              // of them what goes without the effect
  Eigen::VectorXd by_others;
  Eigen::VectorXd by_corrections;  // numbers that are slightly off, beside the effect

  [[nodiscard]] const EffectType* type() const { return chosen->effects[position].type; }

  /// Whether the others are beside a rival, the first effect of its fit, as they are beside the effect.
  [[nodiscard]] bool has_same_others(const IdentificationProblem& problem, const FitOutcome& rival) const {
    const std::span beside{rival.effects.data() + 1, others.size()};
    return is_small(changes_by(problem, beside) - by_others, alone);
  }
};

Place place_in(const IdentificationProblem& problem, const FitOutcome& chosen, std::size_t position,
               const Judgement& judgement) {
  Place place{.chosen = &chosen,
              .position = position,
              .others = {},
              .all = {},
              .alone = {},
              .by_others = {},
              .by_corrections = {}};
  // Numbers that are slightly off, and what goes with the effect.
  const auto may_differ = [&](std::size_t i) {
    return judgement.is_correction(i) || go_together(*chosen.effects[i].type, *chosen.effects[position].type);
  };
  for (std::size_t i = 0; i < chosen.effects.size(); ++i) {
    if (i != position && !may_differ(i)) place.others.push_back(chosen.effects[i]);
  }
  place.all = changes_of(problem, chosen);
  place.alone = place.all - changes_by(problem, without(chosen.effects, position));
  place.by_others = changes_by(problem, place.others);
  std::vector<EffectSetting> causes = place.others;
  causes.push_back(chosen.effects[position]);
  place.by_corrections = place.all - changes_by(problem, causes);
  return place;
}

/// Whether the effect is found already: in this place, or beside it.
bool is_found(const Place& place, const EffectType* type) {
  return type == place.type() || std::ranges::find(place.others, type, &EffectSetting::type) != place.others.end();
}

/// The same problem whose nuisances are the numbers that a rival may need beside it: what it stands for, the
/// other causes and itself are none of them, and a zero is known exactly before a test.
IdentificationProblem with_numbers_beside(IdentificationProblem problem, const Place& place, const EffectType* rival) {
  for (FitSegment& fit : problem.segments) {
    std::vector<Eigen::Index> kept;
    std::vector<const EffectType*> types;
    for (std::size_t i = 0; i < fit.nuisance_types.size(); ++i) {
      const EffectType* const type = fit.nuisance_types[i];
      if (!fit.is_suspect || type == rival || type->traits.number == ModelNumber::offset || is_found(place, type)) {
        continue;
      }
      kept.push_back(static_cast<Eigen::Index>(i));
      types.push_back(type);
    }
    fit.nuisance = Eigen::MatrixXd{fit.nuisance(Eigen::all, kept)};
    fit.nuisance_types = std::move(types);
  }
  return problem;
}

/// The numbers of the model beside a rival and the other causes change no more than those beside the effect; or else
/// they are slightly off only, or as they are beside the effect, and change less than the rival does.
bool are_slight(const IdentificationProblem& problem, const Place& place, const FitOutcome& fit, double within) {
  const std::span causes = std::span{fit.effects}.first(1 + place.others.size());
  if (!fit.with_nuisance && causes.size() == fit.effects.size()) return true;
  const Eigen::VectorXd by_effects = changes_by(problem, causes);
  const Eigen::VectorXd by_numbers = changes_of(problem, fit) - by_effects;
  const Eigen::VectorXd measured =
      stacked_changes(problem, [&](std::size_t i) -> Eigen::VectorXd { return problem.segments[i].measured; });
  const Eigen::VectorXd own = by_effects - changes_by(problem, causes.subspan(1));
  if (by_numbers.norm() <= place.by_corrections.norm()) return true;
  const bool is_slight =
      by_numbers.norm() <= within * measured.norm() || is_small(by_numbers - place.by_corrections, place.alone);
  return is_slight && by_numbers.norm() <= own.norm();
}

/// The difference of two replays is no more than what no model is expected to reproduce.
bool is_negligible(const IdentificationProblem& problem, const FitOutcome& rival, const FitOutcome& chosen) {
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    Eigen::VectorXd difference = Eigen::VectorXd::Zero(fit.baseline.size());
    if (rival.segments[i].change.size() > 0) difference += rival.segments[i].change;
    if (chosen.segments[i].change.size() > 0) difference -= chosen.segments[i].change;
    if (difference.norm() > tuning::kModelAllowance * fit.measured.norm()) return false;
  }
  return true;
}

/// Whether the recordings decide against the rival: by what it leaves, or by numbers at the other channels that would
/// have to be off for it. It is of about the same signature: what it leaves more is of the size that the form of an
/// effect may be wrong by, and counts for certain only where it is there in every block.
bool is_told(const IdentificationProblem& problem, const FitOutcome& rival, const FitOutcome& chosen, double decides) {
  const Loss loss = loss_by(problem, rival, chosen);
  const double of_numbers = rival.cost_of_numbers - chosen.cost_of_numbers;
  if (of_numbers > decides) return true;
  return loss.nats - of_numbers > std::max(loss.standard_error_of_squares, decides) &&
         !is_negligible(problem, rival, chosen);
}

/// The held-out log density with the rival, numbers of the model that it needs included, is smaller by less than
/// decides between two effects, however little is known of that loss.
bool predicts_as_well(const IdentificationProblem& problem, const FitOutcome& rival, const FitOutcome& chosen,
                      double decides) {
  return held_out_score(problem, chosen) - held_out_score(problem, rival) < decides;
}

/// Whether something speaks against the rival by itself. That what it stands for may also be there in part is no doubt
/// about it: it is in its place.
template <class StandsFor>
bool is_refuted(IdentificationProblem problem, StandsFor&& stands_for, const Candidate& rival) {
  for (FitSegment& fit : problem.segments) {
    for (std::size_t i = 0; i < fit.number_types.size(); ++i) {
      if (stands_for(*fit.number_types[i])) fit.number_slopes.col(static_cast<Eigen::Index>(i)).setZero();
    }
  }
  const Candidate instead{.type = rival.type,
                          .fit = refit_effects(problem, rival.fit.effects, rival.fit.with_nuisance)};
  return !refutation(problem, instead).empty();
}

/// Whether these recordings cannot tell the rival, the first effect of its fit, from the chosen one. It may predict
/// less well, within what is known of that, only if it is alike: of the same signature by itself.
bool is_rival(const IdentificationProblem& problem, const VerdictPolicy& policy, const Place& place,
              const Candidate& rival, bool is_alike) {
  const Eigen::VectorXd difference = changes_of(problem, rival.fit) - place.all;
  if (!is_slight(difference, place.alone)) return false;
  const double decides = nats_that_decide(policy.credible);
  const bool may_lose = is_alike && is_small(difference, place.alone);
  if (!may_lose && !predicts_as_well(problem, rival.fit, *place.chosen, decides)) return false;
  if (!place.has_same_others(problem, rival.fit)) return false;
  if (is_told(problem, rival.fit, *place.chosen, decides)) return false;
  const std::vector<ParameterEstimate>& estimates = rival.fit.parameters.front();
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    if (estimates[i].at_bound && estimates[i].value != rival.type->parameters[i].fallback) return false;
  }
  return are_slight(problem, place, rival.fit, policy.numbers_within) &&
         free_parameters(problem, rival.fit, 0) <= free_parameters(problem, *place.chosen, place.position) &&
         !is_refuted(
             problem, [&](const EffectType& type) { return &type == place.type(); }, rival);
}

/// The numbers of the model that a rival needs, and beside one in the place of a law of the model's own form the
/// numbers of that law, which may be slightly off.
std::vector<EffectSetting> numbers_beside(const IdentificationProblem& problem, const Place& place,
                                          const FitOutcome& rival) {
  std::vector<EffectSetting> numbers = wrong_numbers(problem, rival);
  if (place.type()->replacement == nullptr) return numbers;
  for (const EffectType* const type : judged_effects(problem)) {
    if (is_of_law(*type) && !holds(numbers, type)) numbers.push_back(absent(*type));
  }
  return numbers;
}

/// An effect that may be in the place of the chosen one, by its fit at the lower rate.
struct PossibleRival {
  EffectSetting effect;
  bool is_alike = false;  // of the same signature, not only of about the same
};

/// The effect in the place of the chosen one, fitted at the full rate; beside numbers of the model only where it is no
/// rival without them, first for small changes of them and then for any.
std::optional<Candidate> rival_in(const IdentificationProblem& problem, const VerdictPolicy& policy, const Place& place,
                                  const PossibleRival& possible) try {
  const EffectSetting& effect = possible.effect;
  std::vector<EffectSetting> effects{effect};
  effects.insert(effects.end(), place.others.begin(), place.others.end());
  Candidate rival{.type = effect.type, .fit = refit_effects(problem, effects, false)};
  if (is_rival(problem, policy, place, rival, possible.is_alike)) return rival;
  const IdentificationProblem beside = with_numbers_beside(problem, place, effect.type);
  rival.fit = refit_effects(beside, rival.fit.effects, true);
  if (is_rival(beside, policy, place, rival, possible.is_alike)) return rival;
  // A law does not follow its numbers in proportion.
  const std::vector<EffectSetting> numbers = numbers_beside(beside, place, rival.fit);
  if (numbers.empty() || !may_be_slight(changes_of(beside, rival.fit) - place.all, place.alone)) return {};
  effects = rival.fit.effects;
  effects.insert(effects.end(), numbers.begin(), numbers.end());
  rival.fit = refit_effects(problem, effects, false);
  if (is_rival(problem, policy, place, rival, false)) return rival;
  return {};
} catch (const ConfigError&) {
  return {};
}

/// Effects of about the same signature at the lower rate.
std::vector<PossibleRival> of_about_the_same_signature(const IdentificationProblem& coarse, const Place& place,
                                                       const PartProgress& progress) {
  const IdentificationProblem extended = beside_effects(coarse, place.others);
  std::vector<const EffectType*> effects = judged_effects(coarse);
  std::erase_if(effects, [&](const EffectType* type) { return type->replacement != nullptr || is_found(place, type); });
  std::vector<std::optional<PossibleRival>> same(effects.size());
  fit_each(
      coarse.workers, effects.size(),
      [&](std::size_t i) {
        try {
          const IdentificationProblem beside = with_numbers_beside(extended, place, effects[i]);
          const FitOutcome fit = fit_effects(beside, {effects[i]}, true);
          const Eigen::VectorXd difference = place.by_others + changes_of(beside, fit) - place.all;
          if (may_be_slight(difference, place.alone)) {
            same[i] = PossibleRival{.effect = fit.effects.front(), .is_alike = is_small(difference, place.alone)};
          }
        } catch (const ConfigError&) {
          same[i].reset();
        }
      },
      [&](std::size_t done, std::size_t all) { progress.report("effects compared with the causes", done, all); });
  std::vector<PossibleRival> found;
  for (std::optional<PossibleRival>& possible : same) {
    if (possible) found.push_back(std::move(*possible));
  }
  return found;
}

/// Positions of the chosen effects that may be a cause of the verdict, largest share first. Not among them: a law of
/// another form than the model's, and the stiffness of the user's spring beside another cause, which is free beside
/// every candidate.
std::vector<std::size_t> causes_by_share(const IdentificationProblem& problem, const Selection& selection,
                                         const Judgement& judgement) {
  const std::vector<EffectSetting>& effects = selection.chosen.effects;
  std::vector<std::size_t> causes;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    // A single number that is slightly off may be the cause after all, see settle_corrections().
    if (effects.size() == 1 || !judgement.is_correction(i)) causes.push_back(i);
  }
  const std::size_t told = causes.size();
  std::erase_if(causes, [&](std::size_t i) {
    const EffectType& type = *effects[i].type;
    const bool is_of_law = type.interface == EffectInterface::specimen && is_model_number(problem, type);
    const bool is_another_law = replaces_law(effects[i]) && !has_own_form(problem.model, effects[i]);
    return is_another_law || (problem.law_is_spring && is_of_law && told > 1);
  });
  std::ranges::stable_sort(causes, std::greater{}, [&](std::size_t i) { return selection.shares[i]; });
  return causes;
}

/// Of the chosen effect and of its rivals together.
double probability_of_all(const Selection& selection, const Rivals& rivals) {
  double sum = selection.chosen_probabilities[rivals.chosen];
  for (const Candidate& candidate : selection.library) {
    const bool is_rival = std::ranges::find(rivals.fitted, candidate.type, &Candidate::type) != rivals.fitted.end();
    if (is_rival && rivals.chosen == 0) sum += candidate.probability;
  }
  return std::min(1.0, sum);
}

/// Whether a lag of the displacement transducer could look like it: a motion that comes late, or damping.
bool is_late_motion(const EffectType& type) {
  const ModelNumber number = type.traits.number;
  return type.interface == EffectInterface::transfer_system &&
         (number == ModelNumber::delay || number == ModelNumber::bandwidth || type.name == "bandwidth");
}

bool is_damping(const EffectType& type) {
  return &type == find_effect(EffectInterface::specimen, ModelNumber::damping);
}

}  // namespace

bool go_together(const EffectType& one, const EffectType& other) noexcept { return is_of_law(one) && is_of_law(other); }

std::optional<Candidate> lag_of_transducer(IdentificationProblem whole, const std::vector<EffectSetting>& found,
                                           const VerdictPolicy& policy) try {
  const EffectType* const lag = find_effect(EffectInterface::displacement_sensor, "lag");
  const auto is_late = [](const EffectSetting& effect) { return is_late_motion(*effect.type); };
  const auto damps = [](const EffectSetting& effect) { return is_damping(*effect.type) && effect.values[0] > 0.0; };
  if (std::ranges::none_of(found, is_late) || std::ranges::none_of(found, damps)) return {};
  if (std::ranges::find(found, lag, &EffectSetting::type) != found.end()) return {};
  settle_noise(whole, refit_effects(whole, found, false));
  const FitOutcome both = refit_effects(whole, found, false);
  std::vector<EffectSetting> rest = found;
  std::erase_if(rest, [&](const EffectSetting& effect) { return is_late(effect) || damps(effect); });
  const Eigen::VectorXd all = changes_of(whole, both);
  const Eigen::VectorXd by_both = all - changes_by(whole, rest);
  const auto stands_for = [](const EffectType& type) { return is_late_motion(type) || is_damping(type); };
  const auto beside = [&](const std::vector<EffectSetting>& others) {
    std::vector<EffectSetting> effects = others;
    effects.insert(effects.begin(), absent(*lag));
    return Candidate{.type = lag, .fit = search_effects(whole, effects, false)};
  };
  const auto stands_for_both = [&](const Candidate& one) {
    return is_small(changes_of(whole, one.fit) - all, by_both) &&
           !is_told(whole, one.fit, both, nats_that_decide(policy.credible)) && !is_refuted(whole, stands_for, one);
  };
  Candidate one = beside(rest);
  if (one.fit.effects.front().values[0] == 0.0) return {};
  if (stands_for_both(one)) return one;
  // The actuator may be late by a little as well.
  std::vector<EffectSetting> undamped = found;
  std::erase_if(undamped, damps);
  one = beside(undamped);
  if (!stands_for_both(one)) return {};
  const auto late_of = [&](std::vector<EffectSetting> effects) {
    std::erase_if(effects, [&](const EffectSetting& effect) { return !is_late(effect); });
    return changes_by(whole, effects);
  };
  if (!is_slight(late_of(one.fit.effects), late_of(found))) return {};
  return one;
} catch (const ConfigError&) {
  return {};
}

void find_rivals(const IdentificationProblem& problem, const IdentificationProblem& coarse, const Selection& selection,
                 const VerdictPolicy& policy, const PartProgress& progress, Judgement& judgement) {
  if (!report::names_a_cause(judgement.verdict)) return;
  const FitOutcome chosen = refit_effects(problem, selection.chosen.effects, false);
  const FitOutcome thin = refit_effects(coarse, selection.chosen.effects, false);
  const std::vector<std::size_t> causes = causes_by_share(problem, selection, judgement);
  for (std::size_t i = 0; i < causes.size(); ++i) {
    const std::size_t position = causes[i];
    Rivals rivals{.chosen = position, .fitted = {}, .probability = 1.0};
    const Place place = place_in(problem, chosen, position, judgement);
    const std::vector<PossibleRival> same = of_about_the_same_signature(
        coarse, place_in(coarse, thin, position, judgement), progress.round(i, causes.size()));
    std::vector<std::optional<Candidate>> fitted(same.size());
    problem.workers.for_each(same.size(),
                             [&](std::size_t j) { fitted[j] = rival_in(problem, policy, place, same[j]); });
    for (std::optional<Candidate>& rival : fitted) {
      if (rival) rivals.fitted.push_back(*std::move(rival));
    }
    if (rivals.fitted.empty()) continue;
    rivals.probability = probability_of_all(selection, rivals) / static_cast<double>(1 + rivals.fitted.size());
    judgement.rivals = std::move(rivals);
    if (judgement.may_be_set) judgement.verdict = report::Verdict::set;
    return;
  }
}

}  // namespace hybridtest
