#include "diagnosis/verdict/causes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>

#include "diagnosis/tuning.hpp"
#include "diagnosis/verdict/library_fits.hpp"

namespace hybridtest {

namespace {

/// Softmax of the scores.
std::vector<double> probabilities_of(const std::vector<Candidate>& library) {
  std::vector<double> probabilities;
  double sum = 0.0;
  for (const Candidate& candidate : library) {
    probabilities.push_back(std::exp((candidate.score - library.front().score) / tuning::kTemperature));
    sum += probabilities.back();
  }
  for (double& probability : probabilities) probability /= sum;
  return probabilities;
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
    const GapEnergy one = gap_energy(fit, outcome.segments[i]);
    GapEnergy& sum = sums[problem.segments[i].segment.recording];
    sum.total += one.total;
    sum.floor += one.floor;
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

Typical typical(const IdentificationProblem& problem, const FitOutcome& baseline, const FitOutcome& without,
                const Candidate& further) {
  const FitOutcome& with = further.fit;
  const std::map<std::size_t, double> total = excess_of_recordings(problem, baseline, further.type);
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

/// A further effect is accepted only if it improves the score on held-out blocks and explains enough. A wrong number
/// of the model is judged by the gap that it leaves; any other effect also by the whole gap where it acts, unless it
/// leaves hardly anything: even the right effect never has exactly the shape of the real one.
bool earns_its_place(const IdentificationProblem& problem, const FitOutcome& baseline, const FitOutcome& without,
                     const Candidate& with) {
  const double gain = held_out_score(problem, with.fit) - held_out_score(problem, without);
  const Typical change = typical(problem, baseline, without, with);
  const bool matters = is_model_number(problem, *with.type) || change.explains > tuning::kAnotherEffectExplains ||
                       change.leaves < tuning::kSmallEffectLeaves;
  return gain > tuning::kAnotherEffectGain && change.leaves < tuning::kAnotherEffectLeaves && matters;
}

/// Something that a further effect could explain.
bool is_more_left(const GapEnergy& left, double total) {
  constexpr double kVariance = tuning::kSuspectOverFloor * tuning::kSuspectOverFloor;
  return left.excess() > tuning::kNothingLeft * total && left.total > kVariance * left.floor;
}

/// The best of `beside` that is accepted; null when there is none.
/// A wrong number of the model that explains nearly as much is preferred, so that it is not called a missing effect.
const Candidate* first_that_earns(const IdentificationProblem& problem, const FitOutcome& baseline,
                                  const FitOutcome& without, const std::vector<Candidate>& beside) {
  const auto earns = [&](const Candidate& candidate) { return earns_its_place(problem, baseline, without, candidate); };
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

/// The best pair that contains one of the leading effects.
FitOutcome best_start(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                      const Selection& selection, std::size_t threads, const PartProgress& progress) {
  const FitOutcome first = refit_effects(problem, {selection.library.front().fit.effects.front()}, false);
  FitOutcome best = first;
  double best_score = -std::numeric_limits<double>::infinity();
  const double total = gap_energy(problem, selection.baseline).excess();
  if (!is_more_left(gap_energy(problem, first), total)) return best;
  const std::size_t leaders = std::min(tuning::kLeadersPaired, selection.library.size());
  for (std::size_t i = 0; i < leaders; ++i) {
    if (selection.library[i].score < selection.library.front().score - tuning::kFarBehind) break;
    const std::vector<Candidate> beside =
        fit_beside(problem, coarse, {selection.library[i].fit.effects.front()}, threads, progress.round(i, leaders));
    const Candidate* const second = first_that_earns(problem, selection.baseline, first, beside);
    if (second != nullptr && second->score > best_score) {
      best = second->fit;
      best_score = second->score;
    }
  }
  return best;
}

}  // namespace

Selection select_effects(const IdentificationProblem& problem, const IdentificationProblem& coarse, std::size_t threads,
                         const PartProgress& progress) {
  Selection selection;
  selection.baseline = fit_nothing(problem, false);
  selection.chosen = selection.baseline;
  selection.library = fit_library(problem, coarse, threads, progress.part(0.0, tuning::kLibraryFitted));
  if (selection.library.empty()) return selection;
  selection.probabilities = probabilities_of(selection.library);
  if (selection.library.front().score < held_out_score(problem, selection.baseline) + tuning::kDetectionGain) {
    return selection;
  }
  selection.chosen =
      best_start(problem, coarse, selection, threads, progress.part(tuning::kLibraryFitted, tuning::kPairsFitted));
  const double total = gap_energy(problem, selection.baseline).excess();
  while (selection.chosen.effects.size() > 1 && selection.chosen.effects.size() < tuning::kEffectsMax &&
         is_more_left(gap_energy(problem, selection.chosen), total)) {
    const std::vector<Candidate> beside = fit_beside(
        problem, coarse, selection.chosen.effects, threads,
        progress.part(tuning::kPairsFitted, 1.0).round(selection.chosen.effects.size() - 2, tuning::kEffectsMax - 2));
    const Candidate* const next = first_that_earns(problem, selection.baseline, selection.chosen, beside);
    if (next == nullptr) break;
    selection.chosen = next->fit;
  }
  return selection;
}

namespace {

/// Gap explained by the effects whose bits are set.
std::vector<double> explained_by_subset(const IdentificationProblem& problem, const FitOutcome& baseline,
                                        const FitOutcome& chosen, const PartProgress& progress) {
  const std::size_t subsets = std::size_t{1} << chosen.effects.size();
  const double total = gap_energy(problem, baseline).total;
  std::vector<double> explained(subsets, 0.0);
  explained.back() = std::max(0.0, total - gap_energy(problem, chosen).total);
  for (std::size_t subset = 1; subset + 1 < subsets; ++subset) {
    progress.report("combinations of the causes", subset - 1, subsets - 2);
    std::vector<EffectSetting> effects;
    for (std::size_t i = 0; i < chosen.effects.size(); ++i) {
      if ((subset >> i & 1U) != 0) effects.push_back(chosen.effects[i]);
    }
    explained[subset] = std::max(0.0, total - gap_energy(problem, refit_effects(problem, effects, false)).total);
  }
  return explained;
}

double factorial(int n) { return std::tgamma(n + 1.0); }

}  // namespace

std::vector<double> cause_shares(const IdentificationProblem& problem, const FitOutcome& baseline,
                                 const FitOutcome& chosen, const PartProgress& progress) {
  const auto n = static_cast<int>(chosen.effects.size());
  std::vector<double> shares(chosen.effects.size(), 1.0 / std::max(1, n));
  if (n < 2) return shares;
  const std::vector<double> explained = explained_by_subset(problem, baseline, chosen, progress);
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

namespace {

using report::Verdict;

/// Whether a gap exceeds this multiple of the floor of its interface.
bool stands_above_floor(const IdentificationProblem& problem, const Selection& selection, double multiple) {
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    const double gap = selection.baseline.segments[i].mean_square - fit.floor * fit.floor;
    const double floor = fit.sample_floor;
    const double allowance = std::max(0.0, 1.0 / (fit.weight * fit.weight) - fit.floor * fit.floor);
    if (gap > multiple * multiple * floor * floor + allowance) return true;
  }
  return false;
}

Verdict verdict_by_remainder(double left) noexcept {
  if (left <= tuning::kNamedLeaves) return Verdict::named;
  return left <= tuning::kPartialLeaves ? Verdict::partial : Verdict::unknown;
}

/// Several effects that explain a gap only together, and leave part of it, are a curve fit and not a cause.
bool is_patchwork(const IdentificationProblem& problem, const Selection& selection, double total) {
  return selection.chosen.effects.size() > 1 &&
         gap_energy(problem, selection.library.front().fit).excess() > tuning::kPartialLeaves * total;
}

/// The most probable effects, until their sum of probabilities is large enough.
std::vector<std::size_t> credible(const Selection& selection) {
  std::vector<std::size_t> members;
  double sum = 0.0;
  for (std::size_t i = 0; i < selection.library.size() && sum < tuning::kCredible; ++i) {
    members.push_back(i);
    sum += selection.probabilities[i];
  }
  return members;
}

}  // namespace

Judgement judge(const IdentificationProblem& problem, const Selection& selection) {
  Judgement judgement;
  if (!stands_above_floor(problem, selection, tuning::kGapOverFloor)) return judgement;
  if (selection.chosen.effects.empty()) {
    if (!stands_above_floor(problem, selection, tuning::kUnknownOverFloor)) return judgement;
    judgement.verdict = Verdict::unknown;
    judgement.gap_left = 1.0;
    return judgement;
  }
  const double total = gap_energy(problem, selection.baseline).excess();
  judgement.gap_left = total > 0.0 ? gap_energy(problem, selection.chosen).excess() / total : 0.0;
  judgement.verdict = verdict_by_remainder(judgement.gap_left);
  if (judgement.verdict == Verdict::partial && is_patchwork(problem, selection, total)) {
    judgement.verdict = Verdict::unknown;
  }
  const bool is_single = selection.chosen.effects.size() == 1;
  if (judgement.verdict == Verdict::unknown || !is_single) return judgement;
  judgement.indistinguishable = credible(selection);
  if (judgement.verdict == Verdict::named && judgement.indistinguishable.size() > 1) judgement.verdict = Verdict::set;
  return judgement;
}

report::RankedCause ranked(const EffectSetting& effect, const std::vector<ParameterEstimate>& estimates) {
  report::RankedCause cause;
  cause.interface = name_of(effect.type->interface);
  cause.effect = effect.type->name;
  cause.equation = effect.type->equation;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const EffectParameter& parameter = effect.type->parameters[i];
    report::ReportedParameter reported;
    reported.name = parameter.name;
    reported.unit = parameter.unit;
    reported.value = estimates[i].value;
    reported.is_at_bound = estimates[i].at_bound;
    const double half = half_width_95(estimates[i]);
    if (half > 0.0) reported.ci95 = report::Interval{reported.value - half, reported.value + half};
    cause.parameters.push_back(std::move(reported));
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

using report::Verdict;

GapParts gap_parts(const IdentificationProblem& problem, const Selection& selection, const Judgement& judgement,
                   std::span<const Trace> traces) {
  GapParts parts;
  for (const Trace& trace : traces) parts.traced += trace.gap_share;
  if (judgement.verdict == Verdict::none) return parts;
  const double rest = gap_energy(problem, selection.baseline).excess();
  parts.left = judgement.verdict == Verdict::unknown ? rest : judgement.gap_left * rest;
  parts.explained = std::max(0.0, rest - parts.left);
  return parts;
}

Verdict verdict_with(std::span<const Trace> traces, const Judgement& judgement, const GapParts& parts) {
  if (traces.empty()) return judgement.verdict;
  switch (judgement.verdict) {
    case Verdict::none: return Verdict::named;
    case Verdict::set:
      // The set is kept, unless the choice between its members changes hardly anything.
      return parts.traced < (1.0 - tuning::kNamedLeaves) * parts.all() ? Verdict::set : Verdict::named;
    default: return parts.left <= tuning::kNamedLeaves * parts.all() ? Verdict::named : Verdict::partial;
  }
}

void add_traces(std::span<const Trace> traces, const GapParts& parts, std::vector<report::RankedCause>& ranking) {
  const double known = parts.traced + parts.explained;
  if (traces.empty() || known <= 0.0) return;
  for (report::RankedCause& cause : ranking) cause.share *= parts.explained / known;
  for (const Trace& trace : traces) {
    std::vector<ParameterEstimate> read;
    for (const double value : trace.effect.values) read.push_back({.value = value});
    report::RankedCause cause = ranked(trace.effect, read);
    cause.probability = 1.0;
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
