#pragma once

#include <string>
#include <vector>

#include "core/config/section.hpp"

namespace hybridtest {

/// The fluid dampers of a specimen's laws (`viscous` with another exponent than 1, by itself or in `parallel`) as
/// effects `nonlinear_viscous_damping` beside what is left of each law. The specimen is the same; an effect has its
/// numbers by itself, so that a diagnosis can free them.
/// @param rig   of a simulated site, read without errors.
/// @return overrides of the file (see Document::load()) that say so. None where there is no such damper, or where a
///         degree of freedom has more than one.
[[nodiscard]] std::vector<std::string> dampers_beside_law(config::Section rig);

}  // namespace hybridtest
