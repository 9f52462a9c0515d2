#pragma once

#include <cstdint>
#include <span>

#include "diagnosis/identification/segment.hpp"
#include "diagnosis/result/diagnosis_report.hpp"

namespace hybridtest {

/// How far the gap of the first cause's interface shrinks on segments that were not fitted, once the causes
/// are in the model: sample by sample, in free simulation. The interval is of a block bootstrap.
/// @param held_out   all segments of the recordings to judge by; those that no cause touches are left aside.
[[nodiscard]] report::Shrink shrink_on(const SiteModel& model, std::span<const EffectSetting> causes,
                                       std::span<const Segment> held_out, std::uint64_t seed);

/// What may be said of causes once recordings that were not fitted were looked at: causes that act there and surely
/// leave most of the gap are none, however well they go with the recordings that they were found in. Where they
/// explain what one channel shows, another one that shows something new does not speak against them.
/// @param verdict    by the recordings of the fit.
/// @param held_out   of recordings that were not fitted, one for each kind of segment that the causes act on.
[[nodiscard]] report::Verdict verdict_carried_over(report::Verdict verdict, std::span<const report::Shrink> held_out);

}  // namespace hybridtest
