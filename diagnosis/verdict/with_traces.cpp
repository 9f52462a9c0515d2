#include "diagnosis/verdict/with_traces.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/scoring/score.hpp"
#include "diagnosis/tuning.hpp"
#include "diagnosis/verdict/ranked_cause.hpp"

namespace hybridtest {

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
      // Which of the set it is stays open, unless hardly anything depends on it.
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
