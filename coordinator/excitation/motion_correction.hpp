#pragma once

#include <cstdint>

#include "coordinator/excitation/ground_motion.hpp"

namespace hybridtest {

/// What an acceleration leaves the ground with, integrated twice from rest along its straight lines.
struct MotionEnd {
  double velocity_m_per_s = 0.0;
  double displacement_m = 0.0;
};

[[nodiscard]] MotionEnd motion_end(const GroundMotion& motion);

enum class BaselineCorrection : std::uint8_t { none, mean, linear, quadratic };

/// Subtracts from the acceleration a constant, a line or a parabola in time: the one that leaves the ground at rest at
/// the end and, of those, the least mean square of the velocity. The velocity in place of the acceleration is judged
/// because a small offset of the acceleration shows there (Berg and Housner, Bulletin of the Seismological Society of
/// America 51, 1961; the end at rest is that of Boore, ibid. 91, 2001). `mean` is the constant with the end at rest
/// alone: the time average of the acceleration.
void correct_baseline(GroundMotion& motion, BaselineCorrection correction);

/// Butterworth high-pass filter, run forwards and backwards, so that it delays no frequency. At its frequency it leaves
/// half of the amplitude; far below, (f/frequency)^(2 order). Zeros of 1.5 order/frequency in s before and after the
/// motion take up what the filter spreads there (Converse and Brady, USGS Open-File Report 92-296A, 1992; Boore,
/// Bulletin of the Seismological Society of America 95, 2005). They are cut off again, so that the motion keeps its
/// times, and with them a part of what brings the ground back to where it was: correct the baseline afterwards, as PEER
/// does (Ancheta and others, PEER Report 2013/03).
struct HighPassFilter {
  double frequency_hz = 0.1;
  int order = 4;  // of one pass, 1 to kHighPassOrderMax
};
inline constexpr int kHighPassOrderMax = 8;

/// @throws ConfigError for a frequency above a quarter of the sampling rate of the motion, or so low that the zeros
///         would be more than kGroundMotionPointsMax.
void filter(GroundMotion& motion, const HighPassFilter& high_pass);

}  // namespace hybridtest
