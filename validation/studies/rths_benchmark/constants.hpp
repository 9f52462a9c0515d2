#pragma once

#include <cstddef>
#include <limits>

/// Fixed numbers of the virtual real-time hybrid simulation benchmark (Silva, Gomez, Maghareh, Dyke and
/// Spencer, Mech. Syst. Signal Process. 135, 2020). SI.
namespace hybridtest::rths {

/// Of a figure that a run does not have.
inline constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

inline constexpr double kSampleRateHz = 4096.0;
inline constexpr double kPeriodS = 1.0 / kSampleRateHz;

/// White, per sample.
inline constexpr double kDisplacementNoiseM = 1.6e-5;
inline constexpr double kForceNoiseN = 2.18;

/// Of the actuator. Reaching it counts as the loss of a run, unless the reference structure itself comes
/// within kExcusedShare of it.
inline constexpr double kForceLimitN = 8900.0;
inline constexpr double kExcusedShare = 0.95;
/// Past this multiple of the limit a run is no test any more and ends.
inline constexpr double kHopelessShare = 1.5;

inline constexpr double kMotionScale = 0.4;
inline constexpr int kCases = 4;
inline constexpr std::size_t kFloors = 3;

}  // namespace hybridtest::rths
