#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/traces/traces.hpp"
#include "diagnosis/verdict/causes.hpp"
#include "diagnosis/verdict/selection.hpp"

namespace hybridtest {

/// One channel of the chain: the gap in it, what explains it, and the verdict on that.
struct Stage {
  IdentificationProblem problem;  // the channel's own segments are its suspects
  Selection selection;
  Judgement judgement;

  [[nodiscard]] bool has_causes() const { return report::names_a_cause(judgement.verdict); }
  [[nodiscard]] bool changes_model() const { return has_causes() || !judgement.corrections.empty(); }
  /// Whether a cause or, without one, the gap is at this interface.
  [[nodiscard]] bool concerns(std::string_view interface) const;
};

/// The channels of the chain one after the other. What explains a channel is added to the model before the next one is
/// judged: what a channel names of the displacement sensor also changes the force, and a further effect earns nothing
/// by what is explained already.
/// @param whole      the problem of all segments.
[[nodiscard]] std::vector<Stage> judge_stages(const SiteModel& model, std::vector<Segment> segments,
                                              const IdentificationProblem& whole, const VerdictPolicy& policy,
                                              const PartProgress& progress);

/// Causes and corrections.
[[nodiscard]] std::vector<EffectSetting> causes_of(std::span<const Stage> stages, std::span<const Trace> traces);

/// The segments like those in which the fit found a gap. A channel that a cause also changes, but that is within its
/// noise floor with and without the cause, does not show how much of the gap is removed.
[[nodiscard]] std::vector<Segment> at_suspects(const IdentificationProblem& problem, std::span<const Segment> segments);

/// Tells held-out segments of the specimen the noise of their motion, where a stage explains the actuator's channel.
/// @param completed   the model with all causes.
void tell_held_out_noise(const SiteModel& completed, const std::vector<Stage>& stages, std::vector<Segment>& held_out);

/// The verdicts after the check on held-out recordings, each stage's beside the causes of the others.
/// @param notes   says which causes did not hold.
void drop_what_does_not_carry_over(const SiteModel& model, std::span<const Segment> held_out, std::uint64_t seed,
                                   const VerdictPolicy& policy, std::vector<Stage>& stages,
                                   std::vector<std::string>& notes);

}  // namespace hybridtest
