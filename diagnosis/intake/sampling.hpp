#pragma once

#include "diagnosis/intake/raw_recording.hpp"

namespace hybridtest {

/// Share of the period by which one interval may differ from it.
inline constexpr double kEvenSpacing = 0.01;

/// Finds repeated, reversed and unevenly spaced time stamps, gaps, and a period that drifts.
///
/// An interval is even when it differs from the median interval by less than a hundredth or, where
/// the stamps were rounded to digits (1/1024 s written as 0.000977), by the last digit; digits
/// coarser than a tenth of the period cannot excuse anything. The whole must follow an even grid
/// within half a period.
/// @param raw   at least two samples, times finite.
/// @return the period [s]: length over intervals; meaningless when something was found.
[[nodiscard]] double check_sampling(const RawRecording& raw, FindingList& findings);

}  // namespace hybridtest
