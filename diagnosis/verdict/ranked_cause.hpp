#pragma once

#include <vector>

#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/result/diagnosis_report.hpp"

namespace hybridtest {

/// An effect with its parameters and their 95 % intervals, where they have a standard error; its probability, its share
/// and whether it is a cause are left to the caller.
/// @param estimates   one per parameter of the effect, in their order.
[[nodiscard]] report::RankedCause ranked(const EffectSetting& effect, const std::vector<ParameterEstimate>& estimates);

/// The causes first, the larger share before the smaller one; what else was considered stays in its order.
void put_causes_first(std::vector<report::RankedCause>& ranking);

/// Every interface keeps that part of its share of the gap.
void scale_shares(std::vector<report::InterfaceGap>& where, double kept);

}  // namespace hybridtest
