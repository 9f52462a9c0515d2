#pragma once

#include <span>
#include <vector>

#include "diagnosis/traces/trace.hpp"
#include "diagnosis/verdict/judgement.hpp"

namespace hybridtest {

/// The gap that traces make beside the one that was judged without them, each as mean squares over the
/// output's own.
struct GapParts {
  double traced = 0.0;
  double explained = 0.0;  // by the effects chosen
  double left = 0.0;

  [[nodiscard]] double all() const noexcept { return traced + explained + left; }
};
[[nodiscard]] GapParts gap_parts(const IdentificationProblem& problem, const Selection& selection,
                                 const Judgement& judgement, std::span<const Trace> traces);

/// Traces are certain: with any a verdict names them, and all of the gap only if what they do not make is explained
/// too.
[[nodiscard]] report::Verdict verdict_with(std::span<const Trace> traces, const Judgement& judgement,
                                           const GapParts& parts);

/// Lists the traces as causes, in front of what follows a smaller share of the gap.
void add_traces(std::span<const Trace> traces, const GapParts& parts, std::vector<report::RankedCause>& ranking);

/// Gives the traces' interfaces their part of the gap.
void add_traces(std::span<const Trace> traces, const GapParts& parts, std::vector<report::InterfaceGap>& where);

}  // namespace hybridtest
