#pragma once

#include <cstddef>
#include <vector>

#include "diagnosis/intake/intake.hpp"
#include "diagnosis/recording.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

/// Reports columns whose unit seems to differ from the one in their header.
///
/// The displacements of a degree of freedom describe one motion: where one spans 1000, 100 or 39.37
/// times what another spans, and keeps its shape (correlation at least 0.8, up to 50 ms late), it is in millimetres,
/// centimetres or inches. An actuator that is stuck moves as little, but not as commanded. Alone, a displacement is
/// suspected when it passes the largest plausible one or moves faster than the largest plausible
/// speed over 20 ms. An acceleration that goes with the second derivative of the measured displacement (correlation
/// at least 0.8) and is 1/9.81, 100 or 1000 times as large is in g, cm/s2 or mm/s2; at 10^6 or 10^12 times it is
/// the time that is in milli- or microseconds. Force, and time without an acceleration: check_units_against().
/// A quasi-static recording has no speed.
/// @param raw   values finite. @param period_s   positive.
void check_units(const RawRecording& raw, double period_s, FindingList& findings);

/// Reports force and time columns whose unit seems to differ from the one in their header, using the model.
///
/// A force that goes with the predicted one (correlation at least 0.3) and is within a factor of three of a thousandth
/// or a millionth of it, or of what kips would read, is in that unit: no specimen is so much softer than its model. In
/// kilograms or pounds of force it has to be so within 3 %, and to fit the model within a tenth once it is
/// converted: a wrong stiffness may be as large. Time is in milli- or microseconds where samples are a tenth of a
/// second apart or more and the model comes at least three times nearer with a period so much shorter.
/// @param dof   0-based; the recording has it.
[[nodiscard]] std::vector<IntakeFinding> check_units_against(const SiteModel& model, const Recording& recording,
                                                             std::size_t dof);

}  // namespace hybridtest
