#pragma once

#include <cstddef>
#include <limits>

/// Fixed numbers of the virtual real-time hybrid simulation benchmark (Silva, Gomez, Maghareh, Dyke and
/// Spencer, Mech. Syst. Signal Process. 135, 2020). SI.
namespace hybridtest::rths {

/// The value of a criterion that a run does not have.
inline constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

inline constexpr double kSampleRateHz = 4096.0;
inline constexpr double kPeriodS = 1.0 / kSampleRateHz;

/// White noise, standard deviation per sample.
inline constexpr double kDisplacementNoiseM = 1.6e-5;
inline constexpr double kForceNoiseN = 2.18;

/// Force limit of the actuator. A run that reaches it is lost, unless the reference structure itself comes
/// within kExcusedShare of it.
inline constexpr double kForceLimitN = 8900.0;
inline constexpr double kExcusedShare = 0.95;
/// A run ends when it exceeds this multiple of the limit.
inline constexpr double kHopelessShare = 1.5;

inline constexpr double kMotionScale = 0.4;
inline constexpr int kCases = 4;
inline constexpr std::size_t kFloors = 3;

}  // namespace hybridtest::rths
