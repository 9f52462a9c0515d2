#pragma once

#include <string>
#include <vector>

#include "core/config/section.hpp"

namespace hybridtest {

/// The dampers of a specimen's laws, by themselves or in `parallel`, as effects beside what is left of each law:
/// `viscous` as `viscous_damping`, with another exponent than 1 as `nonlinear_viscous_damping`, and `friction` as
/// `coulomb_friction`. The specimen is the same; an effect has its numbers by itself, so that a diagnosis can free
/// them.
/// @param rig   of a simulated site, read without errors.
/// @return overrides of the file (see Document::load()) that say so. None where there is no such damper, or where a
///         degree of freedom has two frictions, or two dampers with an exponent: only one of them could be free.
[[nodiscard]] std::vector<std::string> dampers_beside_law(config::Section rig);

}  // namespace hybridtest
