#pragma once

#include <cstddef>
#include <vector>

#include "diagnosis/intake/finding.hpp"
#include "diagnosis/recording.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

/// Suspects force and time columns of another unit than their header says, by what the model predicts.
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
