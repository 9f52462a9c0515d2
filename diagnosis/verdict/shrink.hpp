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

}  // namespace hybridtest
