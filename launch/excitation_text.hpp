#pragma once

#include <string>

#include "mechanics/structure/vibration_modes.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// What loads the structure, for `hybridtest check`: peaks, factors that were found, what baseline corrections leave,
/// the response spectrum at the periods of the structure, forces, and the way to initial displacements.
[[nodiscard]] std::string excitation_text(const Scenario& scenario, const VibrationModes& modes);

}  // namespace hybridtest
