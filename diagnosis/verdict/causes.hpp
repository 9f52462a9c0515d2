#pragma once

#include <span>
#include <vector>

#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/result/diagnosis_report.hpp"
#include "diagnosis/traces/traces.hpp"
#include "diagnosis/verdict/library_fits.hpp"

namespace hybridtest {

/// The selected effects.
struct Selection {
  FitOutcome baseline;                // the model as the user gave it
  std::vector<Candidate> library;     // every effect by itself, best first
  FitOutcome chosen;                  // effects together; `effects` is empty if no effect is needed
  std::vector<double> probabilities;  // one per entry of `library`: that it is the first cause
};

/// Fits the library, selects the best effect and adds others as long as each removes a large part of the
/// remaining gap on held-out blocks.
/// @param coarse   the same problem at a lower rate, for the searches.
[[nodiscard]] Selection select_effects(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                                       std::size_t threads, const PartProgress& progress);

/// What each of several effects contributes to the gap that they explain together (Shapley, 1953): its
/// gain on held-out blocks, averaged over all orders in which they can be added. Adds up to one.
[[nodiscard]] std::vector<double> cause_shares(const IdentificationProblem& problem, const FitOutcome& baseline,
                                               const FitOutcome& chosen, const PartProgress& progress);

/// The verdict on a gap.
struct Judgement {
  report::Verdict verdict = report::Verdict::none;
  // Positions in Selection::library of effects that cannot be distinguished from the first cause, itself included.
  std::vector<std::size_t> indistinguishable;
  double gap_left = 0.0;  // share of the repeatable gap that the chosen effects leave
};

[[nodiscard]] Judgement judge(const IdentificationProblem& problem, const Selection& selection);

/// An effect with its parameters and their 95 % intervals, where they have a standard error; its probability, its share
/// and whether it is a cause are set by the caller.
/// @param estimates   one per parameter of the effect, in their order.
[[nodiscard]] report::RankedCause ranked(const EffectSetting& effect, const std::vector<ParameterEstimate>& estimates);

/// Sorts the causes to the front, larger share first; the other candidates keep their order.
void put_causes_first(std::vector<report::RankedCause>& ranking);

/// Multiplies the share of every interface by this factor.
void scale_shares(std::vector<report::InterfaceGap>& where, double kept);

/// The gap caused by traces, and the gap judged without them; both as mean squares over that of the
/// output.
struct GapParts {
  double traced = 0.0;
  double explained = 0.0;  // by the effects chosen
  double left = 0.0;

  [[nodiscard]] double all() const noexcept { return traced + explained + left; }
};
[[nodiscard]] GapParts gap_parts(const IdentificationProblem& problem, const Selection& selection,
                                 const Judgement& judgement, std::span<const Trace> traces);

/// Traces are certain: if there are any, the verdict names them. The verdict is complete only if the rest of the gap
/// is explained too.
[[nodiscard]] report::Verdict verdict_with(std::span<const Trace> traces, const Judgement& judgement,
                                           const GapParts& parts);

/// Lists the traces as causes, in front of causes with a smaller share of the gap.
void add_traces(std::span<const Trace> traces, const GapParts& parts, std::vector<report::RankedCause>& ranking);

/// Gives the traces' interfaces their part of the gap.
void add_traces(std::span<const Trace> traces, const GapParts& parts, std::vector<report::InterfaceGap>& where);

}  // namespace hybridtest
