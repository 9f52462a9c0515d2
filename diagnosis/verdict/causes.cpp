#include "diagnosis/verdict/causes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parameters/unit_of.hpp"
#include "diagnosis/identification/law_candidates.hpp"
#include "diagnosis/tuning.hpp"
#include "diagnosis/verdict/growth.hpp"
#include "diagnosis/verdict/refutations.hpp"

namespace hybridtest {
namespace {

using report::Verdict;

/// With more left than a name allows, a cause is one part of the answer.
Verdict verdict_by_remainder(const GapEnergy& after, double left, const VerdictPolicy& policy) noexcept {
  const double over_floor = after.allowed > 0.0 ? std::sqrt(after.total / after.allowed) : 0.0;
  if (left > policy.partial_leaves) return Verdict::unknown;
  return policy.names(left, over_floor) ? Verdict::named : Verdict::partial;
}

/// The gap in units of the outputs. A model that is far off makes it larger than the output itself, and then hardly
/// anything of it would seem to be left: so no output counts more than once.
double gap_to_explain(const IdentificationProblem& problem, const Selection& selection) {
  const auto outputs = static_cast<double>(std::ranges::count_if(problem.segments, &FitSegment::is_suspect));
  return std::min(outputs, gap_energy(problem, selection.baseline).excess());
}

/// Several effects that explain a gap only together, and leave part of it that matters, are a curve fit and not a
/// cause. Other numbers of an element that the model has are no piece of one.
bool is_patchwork(const IdentificationProblem& problem, const Selection& selection, double total, double left,
                  const VerdictPolicy& policy) {
  const auto pieces = std::ranges::count_if(selection.chosen.effects, [&](const EffectSetting& effect) {
    return place_of(problem.model, *effect.type) == nullptr;
  });
  return pieces > 1 && left > tuning::kHardlyLeft &&
         gap_energy(problem, selection.library.front().fit).excess() > policy.partial_leaves * total;
}

/// Several effects of the specimen that are no numbers of the model: more than two of any kind, or two that bend the
/// curve, as a law without a loop does. Few specimens have so many, and a curve that the library lacks is made of as
/// many as it takes.
bool is_pieced_together(const IdentificationProblem& problem, const FitOutcome& chosen) {
  std::size_t effects = 0;
  std::size_t curves = 0;
  for (std::size_t i = 0; i < chosen.effects.size(); ++i) {
    const EffectType& type = *chosen.effects[i].type;
    if (type.interface != EffectInterface::specimen || is_number(problem, type)) continue;
    ++effects;
    if (type.traits.bends_curve || is_law_without_loop(problem, chosen, i)) ++curves;
  }
  return effects > 2 || curves > 1;
}

}  // namespace

double nats_that_decide(double probability) noexcept {
  return tuning::kTemperature * std::log(probability / (1.0 - probability));
}

namespace {

/// Whether a candidate needs this number of the model beside it, so that it is not in its place.
bool stands_beside(const IdentificationProblem& problem, const Candidate& candidate, const EffectType* number) {
  if (!candidate.fit.with_nuisance) return false;
  const std::vector<EffectSetting> numbers = wrong_numbers(problem, candidate.fit);
  return std::ranges::find(numbers, number, &EffectSetting::type) != numbers.end();
}

/// The most probable candidates, until their sum of probabilities is large enough; and, with no more parameters, those
/// that leave less and those of the same signature that the recordings do not tell from the first one, however rare
/// they are.
std::vector<std::size_t> credible(const IdentificationProblem& problem, const Selection& selection,
                                  double probability) {
  const Candidate& first = selection.library.front();
  const double told = nats_that_decide(probability);
  std::vector<std::size_t> members;
  double sum = 0.0;
  for (std::size_t i = 0; i < selection.library.size(); ++i) {
    const Candidate& candidate = selection.library[i];
    const double behind = first.held_out - candidate.held_out;
    const bool is_untold = behind <= 0.0 || (behind <= told && are_alike(first.fit, candidate.fit));
    const bool is_simple = candidate.parameters <= first.parameters && !stands_beside(problem, candidate, first.type);
    if (i == 0 || sum < probability || (is_untold && is_simple)) members.push_back(i);
    sum += candidate.probability;
  }
  return members;
}

/// How late a ramp is at last that goes as far and takes as long as a segment, as it comes out of the model's transfer
/// system [s].
double delay_of_ramp_s(const IdentificationProblem& problem, const SiteModel& model, const Segment& like) {
  const double length_s = like.period_s * static_cast<double>(like.input.size());
  const double speed_m_per_s = problem.scales.displacement_m / length_s;
  const std::unique_ptr<TransferSystem> transfer_system = transfer_system_of(model, like.period_s);
  double late_s = 0.0;
  for (double time_s = 0.0; time_s < length_s; time_s += like.period_s) {
    late_s = time_s - transfer_system->step(speed_m_per_s * time_s) / speed_m_per_s;
  }
  return late_s;
}

/// The delay or the bandwidth is off for certain by more than this share of the model's own delay. An output with
/// little in it that is fast hardly shows that.
bool delays_by_more_than(const IdentificationProblem& problem, const EffectSetting& effect,
                         const ParameterEstimate& estimate, double share) {
  const auto touched = std::ranges::find_if(
      problem.segments, [&](const FitSegment& fit) { return fit.is_suspect && fit.segment.touched_by(*effect.type); });
  if (touched == problem.segments.end() || estimate.value == 0.0) return false;
  const double own_s = delay_of_ramp_s(problem, problem.model, touched->segment);
  double off_s = effect.values[0];
  if (effect.type->traits.number == ModelNumber::bandwidth) {
    SiteModel with = problem.model;
    add_effect(with, effect);
    off_s = delay_of_ramp_s(problem, with, touched->segment) - own_s;
  }
  const double sure_s = std::abs(off_s) * (1.0 - half_width_95(estimate) / std::abs(estimate.value));
  return own_s > 0.0 && sure_s > share * own_s;
}

/// Numbers of the model that are slightly off, of its law all together, too. Not among them: a zero, which is known
/// exactly before a test, and damping that the model does not have.
std::vector<std::size_t> slightly_off(const IdentificationProblem& problem, const Selection& selection, double share) {
  std::vector<std::size_t> corrections;
  for (std::size_t i = 0; i < selection.chosen.effects.size(); ++i) {
    const EffectSetting& effect = selection.chosen.effects[i];
    const ModelNumber number = effect.type->traits.number;
    const bool is_in_model = holds(problem.model.effects, effect.type);
    const bool is_number = is_in_model || (number != ModelNumber::none && number != ModelNumber::damping) ||
                           (replaces_law(effect) && has_own_form(problem.model, effect));
    if (!is_number || number == ModelNumber::offset) continue;
    // An output follows a gain, a stiffness or a strength in proportion. A delay and a bandwidth that are as much off
    // change it by less.
    const bool is_timing = number == ModelNumber::delay || number == ModelNumber::bandwidth;
    const ParameterEstimate& estimate = selection.chosen.parameters[i].front();
    if (is_timing && delays_by_more_than(problem, effect, estimate, 2.0 * share)) continue;
    if (changes_at_most(problem, effect, is_timing ? 0.5 * share : share)) corrections.push_back(i);
  }
  return corrections;
}

/// The one chosen effect that is not a wrong number of the model beside another; null when there are several.
const EffectType* only_cause(const IdentificationProblem& problem, const Selection& selection,
                             const Judgement& judgement) {
  const std::vector<EffectSetting>& effects = selection.chosen.effects;
  if (effects.size() == 1) return effects.front().type;
  const EffectType* only = nullptr;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (is_model_number(problem, *effects[i].type) || judgement.is_correction(i)) continue;
    if (only != nullptr) return nullptr;
    only = effects[i].type;
  }
  return only;
}

}  // namespace

bool Judgement::is_correction(std::size_t chosen) const {
  return std::ranges::find(corrections, chosen) != corrections.end();
}

Judgement judge(const IdentificationProblem& problem, const Selection& selection, const VerdictPolicy& policy) {
  Judgement judgement;
  if (!stands_above_floor(problem, selection.baseline, tuning::kGapOverFloor)) return judgement;
  // A gap that hardly stands above its floor may be none: it is one only where something explains it.
  const bool is_clear = stands_above_floor(problem, selection.baseline, tuning::kNearFloor);
  if (selection.chosen.effects.empty()) {
    if (!is_clear) return judgement;
    judgement.verdict = Verdict::unknown;
    judgement.gap_left = 1.0;
    return judgement;
  }
  const double total = gap_to_explain(problem, selection);
  const GapEnergy after = gap_energy(problem, selection.chosen);
  judgement.gap_left = total > 0.0 ? after.excess() / total : 0.0;
  judgement.verdict = verdict_by_remainder(after, judgement.gap_left, policy);
  if (judgement.verdict == Verdict::partial && is_patchwork(problem, selection, total, judgement.gap_left, policy)) {
    judgement.verdict = Verdict::unknown;
  }
  if (judgement.verdict == Verdict::unknown) return is_clear ? judgement : Judgement{};
  judgement.leaves_a_part = judgement.verdict == Verdict::partial;
  // A set says less than a name, and may leave what hardly matters.
  judgement.may_be_set = judgement.verdict == Verdict::named || judgement.gap_left <= tuning::kHardlyLeft;
  // Where a search ran into its limit, something else may be meant.
  for (std::size_t i = 0; i < selection.chosen.effects.size(); ++i) {
    if (!is_cut_off(problem, selection.chosen, i)) continue;
    judgement.verdict = Verdict::partial;
    judgement.may_be_set = false;
  }
  judgement.corrections = slightly_off(problem, selection, policy.numbers_within);
  if (is_pieced_together(problem, selection.chosen)) {
    judgement.is_pieced_together = true;
    judgement.verdict = Verdict::partial;
    judgement.may_be_set = false;
  }
  // Nor is a name given to what may be absent by the interval that is reported with it.
  for (std::size_t i = 0; i < selection.chosen.effects.size(); ++i) {
    if (!may_be_absent(problem, selection.chosen, i)) continue;
    if (judgement.is_correction(i)) {
      judgement.may_be_right = !is_clear;
      continue;
    }
    judgement.may_be_absent.push_back(i);
    judgement.verdict = Verdict::partial;
  }
  judgement.only_corrects = judgement.corrections.size() == selection.chosen.effects.size();
  // One of the leaders still, if none was exchanged for it; perhaps beside other causes.
  const std::vector<EffectSetting>& effects = selection.chosen.effects;
  const auto is_told = [&](const AlikeLeader& leader) {
    const auto found = std::ranges::find(effects, leader.type, &EffectSetting::type);
    return found != effects.end() && !judgement.is_correction(static_cast<std::size_t>(found - effects.begin()));
  };
  if (selection.library.front().type == only_cause(problem, selection, judgement)) {
    judgement.indistinguishable = credible(problem, selection, policy.credible);
  } else if (std::ranges::any_of(selection.alike, is_told)) {
    const std::vector<Candidate>& library = selection.library;
    for (const AlikeLeader& leader : selection.alike) {
      const auto place = std::ranges::find(library, leader.type, &Candidate::type) - library.begin();
      judgement.indistinguishable.push_back(static_cast<std::size_t>(place));
    }
  }
  if (judgement.may_be_set && judgement.indistinguishable.size() > 1) judgement.verdict = Verdict::set;
  return judgement;
}

namespace {

/// The estimate with what is not known of the form of its effect or law: it is never quite that of the site, so its
/// numbers are known no better than those of a model are. One that was not fitted stays as it is.
ParameterEstimate with_doubt_of_form(ParameterEstimate estimate) {
  if (estimate.beside_wrong_numbers == 0.0) return estimate;
  estimate.beside_wrong_numbers =
      std::hypot(estimate.beside_wrong_numbers, tuning::kNumbersWithin * std::abs(estimate.value));
  return estimate;
}

/// Whether the form of the effect leaves its parameter in doubt: not a number of the model, nor an instant.
bool depends_on_form(const EffectSetting& effect, const EffectParameter& parameter) {
  const std::optional<SearchRange> range = range_of(*effect.type, parameter);
  return !are_numbers({&effect, 1}) && !(range && range->is_instant());
}

report::ReportedParameter reported(std::string_view name, std::string_view unit, const ParameterEstimate& estimate) {
  report::ReportedParameter parameter{.name = std::string{name}, .unit = std::string{unit}, .value = estimate.value};
  parameter.is_at_bound = estimate.at_bound;
  parameter.is_at_least = estimate.at_least;
  const double half = half_interval_95(estimate);
  if (half > 0.0) parameter.ci95 = report::Interval{estimate.value - half, estimate.value + half};
  return parameter;
}

/// A law's own parameters with their standard errors, to first order from the searched ones: those that go together
/// may leave a product of theirs much better known than either.
std::vector<report::ReportedParameter> parameters_of_law(const EffectSetting& effect,
                                                         const std::vector<ParameterEstimate>& estimates,
                                                         const Eigen::MatrixXd& covariance) {
  const LawReplacement& law = *effect.type->replacement;
  const std::vector<LawParameter> own = law.written(effect.values);
  std::vector<ParameterEstimate> found(own.size());
  Eigen::MatrixXd slopes(static_cast<Eigen::Index>(own.size()), static_cast<Eigen::Index>(effect.values.size()));
  for (std::size_t j = 0; j < effect.values.size(); ++j) {
    std::vector<double> moved = effect.values;
    const double step = tuning::kCoefficientStep * (moved[j] == 0.0 ? 1.0 : moved[j]);
    moved[j] += step;
    const std::vector<LawParameter> there = law.written(moved);
    for (std::size_t i = 0; i < own.size(); ++i) {
      const double slope = (there[i].value - own[i].value) / step;
      slopes(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = slope;
      found[i].at_bound = found[i].at_bound || (slope != 0.0 && estimates[j].at_bound);
    }
  }
  const Eigen::VectorXd variances = (slopes * covariance * slopes.transpose()).diagonal();
  std::vector<report::ReportedParameter> parameters;
  for (std::size_t i = 0; i < own.size(); ++i) {
    found[i].value = own[i].value;
    found[i].freedom = estimates.front().freedom;
    found[i].beside_wrong_numbers = std::sqrt(std::max(0.0, variances[static_cast<Eigen::Index>(i)]));
    parameters.push_back(reported(own[i].name, unit_of(own[i].name), with_doubt_of_form(found[i])));
  }
  return parameters;
}

}  // namespace

report::RankedCause ranked(const SiteModel& model, const FitOutcome& fit, std::size_t position) {
  const EffectSetting& effect = fit.effects[position];
  report::RankedCause cause = ranked(effect, fit.parameters[position], fit.covariances[position]);
  const EffectSetting* const own = place_of(model, *effect.type);
  if (own == nullptr) return cause;
  for (std::size_t i = 0; i < cause.parameters.size(); ++i) {
    report::ReportedParameter& parameter = cause.parameters[i];
    const EffectParameter& limits = effect.type->parameters[i];
    parameter.in_model = own->values[i];
    // None of it is left, or it is as it was: no limit that a search ran into.
    if (parameter.value == limits.neutral || parameter.value == own->values[i]) parameter.is_at_bound = false;
    if (parameter.ci95) parameter.ci95->low = std::max(parameter.ci95->low, limits.low);
  }
  return cause;
}

report::RankedCause ranked(const EffectSetting& effect, const std::vector<ParameterEstimate>& estimates,
                           const Eigen::MatrixXd& covariance) {
  report::RankedCause cause;
  cause.interface = name_of(effect.type->interface);
  cause.effect = effect.type->name;
  cause.equation = effect.type->equation;
  cause.is_formula = effect.type->formula != nullptr;
  cause.input = effect.type->input;
  if (effect.type->replacement != nullptr) {
    cause.law = effect.type->replacement->law;
    cause.in_words = effect.type->replacement->in_words;
    cause.parameters = parameters_of_law(effect, estimates, covariance);
    return cause;
  }
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const EffectParameter& parameter = effect.type->parameters[i];
    const ParameterEstimate estimate =
        depends_on_form(effect, parameter) ? with_doubt_of_form(estimates[i]) : estimates[i];
    cause.parameters.push_back(reported(parameter.name, parameter.unit, estimate));
    // Left out, and so no limit that a search ran into.
    if (estimates[i].value == parameter.fallback) cause.parameters.back().is_at_bound = false;
  }
  return cause;
}

void put_causes_first(std::vector<report::RankedCause>& ranking) {
  std::ranges::stable_sort(ranking, [](const report::RankedCause& a, const report::RankedCause& b) {
    return a.is_cause && (!b.is_cause || a.share > b.share);
  });
}

void scale_shares(std::vector<report::InterfaceGap>& where, double kept) {
  for (report::InterfaceGap& gap : where) {
    gap.share *= kept;
    gap.share_ci95 = {gap.share_ci95.low * kept, gap.share_ci95.high * kept};
  }
}

void add_gap(const IdentificationProblem& problem, const Selection& selection, const Judgement& judgement,
             GapParts& parts) {
  if (judgement.verdict == Verdict::none) return;
  const double rest = gap_to_explain(problem, selection);
  const bool is_all_left = judgement.verdict == Verdict::unknown && judgement.corrections.empty();
  const double left = is_all_left ? rest : judgement.gap_left * rest;
  parts.left += left;
  parts.explained += std::max(0.0, rest - left);
}

void settle_corrections(std::span<Judgement* const> judgements) {
  const auto is_wrong_besides = [](const Judgement* one) {
    return one->verdict == Verdict::unknown || (report::names_a_cause(one->verdict) && !one->only_corrects);
  };
  std::size_t numbers = 0;
  for (const Judgement* one : judgements) numbers += one->corrections.size();
  const bool may_be_right = std::ranges::any_of(judgements, [](const Judgement* one) { return one->may_be_right; });
  const bool is_a_cause = numbers == 1 && !may_be_right && std::ranges::none_of(judgements, is_wrong_besides);
  for (Judgement* const one : judgements) {
    if (!one->only_corrects) continue;
    if (is_a_cause) {
      one->corrections.clear();
    } else if (one->verdict == Verdict::named || one->verdict == Verdict::set) {
      one->verdict = Verdict::none;
    } else if (one->verdict == Verdict::partial) {
      one->verdict = Verdict::unknown;
    }
  }
}

Verdict verdict_of(std::span<const Judgement> judgements) {
  const auto count = [&](Verdict verdict) { return std::ranges::count(judgements, verdict, &Judgement::verdict); };
  const auto gaps = static_cast<std::ptrdiff_t>(judgements.size()) - count(Verdict::none);
  if (gaps == 0) return Verdict::none;
  if (count(Verdict::unknown) == gaps) return Verdict::unknown;
  if (count(Verdict::unknown) + count(Verdict::partial) > 0) return Verdict::partial;
  return count(Verdict::set) > 0 ? Verdict::set : Verdict::named;
}

void settle_set(report::DiagnosisReport& report, bool leaves_a_part) {
  if (report.verdict != Verdict::set || report.ranking.empty() || report.ranking.front().is_indistinguishable) return;
  for (report::RankedCause& cause : report.ranking) {
    // What was chosen has a share.
    if (cause.is_indistinguishable && cause.share == 0.0) cause.is_cause = false;
  }
  const bool is_doubtful = std::ranges::any_of(
      report.ranking, [](const report::RankedCause& cause) { return cause.is_cause && cause.may_be_absent; });
  report.verdict = leaves_a_part || is_doubtful ? Verdict::partial : Verdict::named;
  put_causes_first(report.ranking);
  // What is certain comes before what is chosen of several.
  const auto alternatives = std::ranges::find_if_not(report.ranking, &report::RankedCause::is_cause);
  std::stable_partition(report.ranking.begin(), alternatives,
                        [](const report::RankedCause& cause) { return !cause.is_indistinguishable; });
}

Verdict verdict_with(std::span<const Trace> traces, Verdict verdict, const GapParts& parts) {
  if (traces.empty()) return verdict;
  switch (verdict) {
    case Verdict::none:
    case Verdict::named: return Verdict::named;
    case Verdict::set:
      // The set is kept, unless the choice between its members changes hardly anything.
      return parts.traced < (1.0 - tuning::kHardlyLeft) * parts.all() ? Verdict::set : Verdict::named;
      // What the channels leave counts where it shows beside what the digits hold.
    default: return parts.left <= tuning::kHardlyLeft * parts.traced ? Verdict::named : Verdict::partial;
  }
}

void add_traces(std::span<const Trace> traces, const GapParts& parts, std::vector<report::RankedCause>& ranking) {
  const double known = parts.traced + parts.explained;
  if (traces.empty() || known <= 0.0) return;
  for (report::RankedCause& cause : ranking) cause.share *= parts.explained / known;
  for (const Trace& trace : traces) {
    std::vector<ParameterEstimate> read;
    for (const double value : trace.effect.values) read.push_back({.value = value});
    report::RankedCause cause = ranked(trace.effect, read, {});
    cause.probability = trace.probability;
    cause.share = trace.gap_share / known;
    cause.is_cause = true;
    ranking.push_back(std::move(cause));
  }
  put_causes_first(ranking);
}

void add_traces(std::span<const Trace> traces, const GapParts& parts, std::vector<report::InterfaceGap>& where) {
  const double all = parts.all();
  if (traces.empty() || all <= 0.0) return;
  scale_shares(where, (parts.explained + parts.left) / all);
  for (const Trace& trace : traces) {
    const auto name = name_of(trace.effect.type->interface);
    auto found = std::ranges::find(where, name, &report::InterfaceGap::interface);
    if (found == where.end()) {
      where.push_back({.interface = std::string{name}, .is_judged = true});
      found = where.end() - 1;
    }
    const double share = trace.gap_share / all;
    found->share += share;
    found->share_ci95 = {found->share_ci95.low + share, found->share_ci95.high + share};
    found->nrmse = std::hypot(found->nrmse, std::sqrt(trace.gap_share));
    found->is_at_fault = true;
  }
  std::ranges::stable_sort(where, std::greater{}, &report::InterfaceGap::share);
}

}  // namespace hybridtest
