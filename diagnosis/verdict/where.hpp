#pragma once

#include <cstdint>
#include <vector>

#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/result/diagnosis_report.hpp"

namespace hybridtest {

/// What each interface has of the gap: the energy of its residual above its floor, relative to the
/// energy of its output; shares add up to one.
///
/// A gap that a chosen sensor effect explains is the sensor's, not that of the stage it is seen in, which is listed
/// with what is left there.
/// @param chosen   fit of the causes; equal to `baseline` when there is none.
/// @param seed     of the block bootstrap behind the intervals.
[[nodiscard]] std::vector<report::InterfaceGap> locate(const IdentificationProblem& problem, const FitOutcome& baseline,
                                                       const FitOutcome& chosen, std::uint64_t seed);

}  // namespace hybridtest
