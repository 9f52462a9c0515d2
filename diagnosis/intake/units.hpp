#pragma once

#include "diagnosis/intake/raw_recording.hpp"

namespace hybridtest {

/// No site moves further or faster; a column of metres that does is in another unit.
inline constexpr double kLargestPlausibleDisplacement_m = 10.0;
inline constexpr double kLargestPlausibleSpeed_m_per_s = 10.0;

/// Suspects columns of another unit than their header says.
///
/// The displacements of a degree of freedom describe one motion: where one spans 1000, 100 or 39.37
/// times what another spans, it is in millimetres, centimetres or inches. Alone, a displacement is
/// suspected when it passes the largest plausible one or moves faster than the largest plausible
/// speed over 20 ms. An acceleration that goes with the second derivative of the measured displacement (correlation
/// at least 0.8) and is 1/9.81, 100 or 1000 times as large is in g, cm/s2 or mm/s2; at 10^6 or 10^12 times it is
/// the time that is in milli- or microseconds. Force, and time without an acceleration: check_units_against().
/// @param raw   values finite. @param period_s   positive.
void check_units(const RawRecording& raw, double period_s, FindingList& findings);

}  // namespace hybridtest
