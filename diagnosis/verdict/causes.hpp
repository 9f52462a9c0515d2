#pragma once

#include <span>
#include <vector>

#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/result/diagnosis_report.hpp"
#include "diagnosis/traces/traces.hpp"
#include "diagnosis/verdict/library_fits.hpp"

namespace hybridtest {

/// The effects that the evidence asks for.
struct Selection {
  FitOutcome baseline;                // the model as the user gave it
  std::vector<Candidate> library;     // every effect by itself, best first
  FitOutcome chosen;                  // effects together; none in `effects` when the gap asks for none
  std::vector<double> probabilities;  // one per entry of `library`: that it is the first cause
};

/// Fits the library, takes the best effect and adds others for as long as each removes a good part of
/// what is left, on held-out blocks.
/// @param coarse   the same problem at a lower rate, for the searches.
[[nodiscard]] Selection select_effects(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                                       std::size_t threads, const FitProgress& progress);

/// What each of several effects contributes to the gap that they explain together (Shapley, 1953): its
/// gain on held-out blocks, averaged over all orders in which they can be added. Adds up to one.
[[nodiscard]] std::vector<double> cause_shares(const IdentificationProblem& problem, const FitOutcome& baseline,
                                               const FitOutcome& chosen);

/// What may be said of a gap.
struct Judgement {
  report::Verdict verdict = report::Verdict::none;
  // Positions in Selection::library of what cannot be told from the first cause; it is one of them.
  std::vector<std::size_t> indistinguishable;
  double gap_left = 0.0;  // share of the repeatable gap that the chosen effects leave
};

[[nodiscard]] Judgement judge(const IdentificationProblem& problem, const Selection& selection);

/// An effect with its parameters and their 95 % intervals, where they have a standard error; its probability, its share
/// and whether it is a cause are left to the caller.
/// @param estimates   one per parameter of the effect, in their order.
[[nodiscard]] report::RankedCause ranked(const EffectSetting& effect, const std::vector<ParameterEstimate>& estimates);

/// The causes first, the larger share before the smaller one; what else was considered stays in its order.
void put_causes_first(std::vector<report::RankedCause>& ranking);

/// Every interface keeps that part of its share of the gap.
void scale_shares(std::vector<report::InterfaceGap>& where, double kept);

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
