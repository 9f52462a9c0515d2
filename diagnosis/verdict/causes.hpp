#pragma once

#include <optional>
#include <span>
#include <vector>

#include "diagnosis/result/diagnosis_report.hpp"
#include "diagnosis/traces/traces.hpp"
#include "diagnosis/verdict/policy.hpp"
#include "diagnosis/verdict/selection.hpp"

namespace hybridtest {

/// Effects that cannot be distinguished from a chosen one, see find_rivals().
struct Rivals {
  std::size_t chosen = 0;         // position in Selection::chosen
  std::vector<Candidate> fitted;  // each in the place of the chosen one: it first, then the others that were chosen
  double probability = 0.0;       // of each of them and of the chosen one
};

/// The verdict on the gap of one interface.
struct Judgement {
  report::Verdict verdict = report::Verdict::none;
  // Positions in Selection::library of effects that cannot be distinguished from the first cause, itself included.
  std::vector<std::size_t> indistinguishable;
  // Positions in Selection::chosen of numbers of the model that are slightly off: corrected, but no causes.
  std::vector<std::size_t> corrections;
  // Likewise of causes that are absent at a value within the interval that is reported with them.
  std::vector<std::size_t> may_be_absent;
  // A number of the model that is corrected may as well be right, and the gap hardly stands above its floor.
  bool may_be_right = false;
  bool is_pieced_together = false;  // the causes are so many that they may stand for one that the library lacks
  std::optional<Rivals> rivals;
  bool only_corrects = false;  // nothing else was chosen
  bool may_be_set = false;     // what is left allows one, and no search ran into its limit
  bool leaves_a_part = false;  // more is left than a name allows, of fitted recordings or of held-out ones
  double gap_left = 0.0;       // share of the repeatable gap that the chosen effects leave

  [[nodiscard]] bool is_correction(std::size_t chosen) const;
};

/// Advantage in log density at which one of two candidates has this probability [nats].
[[nodiscard]] double nats_that_decide(double probability) noexcept;

[[nodiscard]] Judgement judge(const IdentificationProblem& problem, const Selection& selection,
                              const VerdictPolicy& policy = {});

/// A gap that nothing causes but numbers of the model that are slightly off is `none`: the numbers of a model never are
/// exact. But where a single number is off for certain and nothing else is wrong at any interface, it is the cause.
void settle_corrections(std::span<Judgement* const> judgements);

/// An effect with its parameters and their 95 % intervals, where they have a standard error; its probability, its share
/// and whether it is a cause are set by the caller.
/// @param model      that the fit adds the effect to.
/// @param position   of the effect among those of the fit.
[[nodiscard]] report::RankedCause ranked(const SiteModel& model, const FitOutcome& fit, std::size_t position);
/// @param estimates    one per parameter of the effect, in their order.
/// @param covariance   of them; of a law in place of the specimen's own only.
[[nodiscard]] report::RankedCause ranked(const EffectSetting& effect, const std::vector<ParameterEstimate>& estimates,
                                         const Eigen::MatrixXd& covariance);

/// Sorts the causes to the front, larger share first; the other candidates keep their order.
void put_causes_first(std::vector<report::RankedCause>& ranking);

/// A set is the verdict on the whole only where it is in doubt which effect has the largest share. Beside a cause that
/// is certain, the effects that cannot be told from a smaller one are alternatives, and that one comes last. Then the
/// verdict is `named`, or `partial` where a part is left or a cause may be absent.
/// @param leaves_a_part   of a gap, more than a name allows.
void settle_set(report::DiagnosisReport& report, bool leaves_a_part);

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
/// Adds the gap of the suspect segments of one problem.
void add_gap(const IdentificationProblem& problem, const Selection& selection, const Judgement& judgement,
             GapParts& parts);

/// The verdict on all interfaces, from that on each: one of them never silences another. A cause that is named beside
/// an interface without one is `partial`.
[[nodiscard]] report::Verdict verdict_of(std::span<const Judgement> judgements);

/// Traces are certain: if there are any, the verdict names them. The verdict is complete only if the rest of the gap
/// is explained too.
[[nodiscard]] report::Verdict verdict_with(std::span<const Trace> traces, report::Verdict verdict,
                                           const GapParts& parts);

/// Lists the traces as causes, in front of causes with a smaller share of the gap.
void add_traces(std::span<const Trace> traces, const GapParts& parts, std::vector<report::RankedCause>& ranking);

/// Gives the traces' interfaces their part of the gap.
void add_traces(std::span<const Trace> traces, const GapParts& parts, std::vector<report::InterfaceGap>& where);

}  // namespace hybridtest
