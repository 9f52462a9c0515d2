#pragma once

#include <cstdint>
#include <span>

#include "diagnosis/identification/problem.hpp"
#include "diagnosis/result/diagnosis_report.hpp"
#include "diagnosis/verdict/policy.hpp"

namespace hybridtest {

/// The gap at the interface of the first cause on held-out segments, before and after the causes are added to the
/// model: sample by sample, in free simulation. The interval comes from a block bootstrap.
/// @param held_out   all segments of the recordings to judge by; those that no cause changes are ignored.
/// @param fitted     with settled noise: what it is there beside the fit, it is at least in held-out segments of the
///                   same kind. Without any, noise is what the channels show of it.
[[nodiscard]] report::Shrink shrink_on(const SiteModel& model, std::span<const EffectSetting> causes,
                                       std::span<const Segment> held_out, std::uint64_t seed,
                                       std::span<const FitSegment> fitted = {});

/// Whether a held-out recording is further from the model with the causes than without them, by more than its floor.
[[nodiscard]] bool is_worse(const report::Shrink& held_out);

/// Whether the causes change the prediction of a held-out recording, beside its floor.
[[nodiscard]] bool acts(const report::Shrink& held_out);

/// Whether more is left of one of them than a name allows.
[[nodiscard]] bool leave_a_part(std::span<const report::Shrink> held_out, const VerdictPolicy& policy);

/// The verdict after the check on held-out recordings. Causes that act there but certainly leave more of the gap above
/// the floor than the policy allows are rejected, even if they fit the fitted recordings well; so are causes that make
/// it larger. If they explain the gap of one channel, a new gap in another channel does not reject them.
/// @param verdict    from the fitted recordings.
/// @param held_out   of held-out recordings, one for each kind of segment that the causes act on.
[[nodiscard]] report::Verdict verdict_carried_over(report::Verdict verdict, std::span<const report::Shrink> held_out,
                                                   const VerdictPolicy& policy = {});

}  // namespace hybridtest
