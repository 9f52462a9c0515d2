#pragma once

#include <cstddef>

/// Numbers that were chosen for the report of a run.
namespace hybridtest::run_report {

/// Columns that a history is thinned to: two for each pixel of a figure.
inline constexpr std::size_t kHistoryColumns = 1800;
/// Points that a loop is thinned to.
inline constexpr std::size_t kLoopPoints = 8000;
/// Degrees of freedom in a figure, those with the largest peaks first.
inline constexpr std::size_t kDofsShown = 6;
/// Events in the table; the others stay in the recording.
inline constexpr std::size_t kEventsShown = 200;
/// Marks on a time axis: more cannot be told apart.
inline constexpr std::size_t kMarksShown = 60;

/// Segment of a transfer estimate [s], and the share of the test that it may be at most: several segments are needed to
/// tell what goes with the target from what does not.
inline constexpr double kSegment_s = 8.0;
inline constexpr double kSegmentShare = 0.2;
/// Frequencies are shown where this share of the motion goes with the target's, and the target has this share of its
/// largest power.
inline constexpr double kCoherenceMin = 0.8;
inline constexpr double kPowerMin = 1e-6;

/// The axis of an estimated delay covers all but this share of its values at either end: while the specimen rests, the
/// estimate is noise.
inline constexpr double kOutlierShare = 0.03;

/// Bins of a histogram of times in each decade, and its range [us].
inline constexpr int kBinsPerDecade = 20;
inline constexpr double kShortest_us = 0.1;
inline constexpr int kDecades = 10;

/// Share of a limit from which an interlock is called near.
inline constexpr double kNearLimit = 0.8;

}  // namespace hybridtest::run_report
