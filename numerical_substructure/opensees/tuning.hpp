#pragma once

#include "core/time.hpp"

namespace hybridtest {

/// Of the displacements inside the model, last correction of an iteration. [m]
inline constexpr double kOpenSeesTolerance_m = 1e-10;
/// Displacement at which the initial stiffness is asked for: large against rounding, small against any yielding. [m]
inline constexpr double kStiffnessProbe_m = 1e-7;
/// A step of a large model takes seconds.
inline constexpr double kOpenSeesAnswer_s = 60.0;
/// The rest of a reply whose beginning has come.
inline constexpr Duration kReplyRest = from_seconds(1.0);
/// To leave in order, after its requests have ended.
inline constexpr Duration kOpenSeesLeave = from_seconds(0.2);
/// Lines of its output that an error shows.
inline constexpr std::size_t kOpenSeesLines = 8;

}  // namespace hybridtest
