#pragma once

#include <vector>

#include "core/config/section.hpp"

namespace hybridtest {

/// What the effects of the numerical substructure make of the part that is computed, as factors.
struct NumericalErrors {
  double mass = 1.0;       // of the structure, with the load of the ground motion
  double stiffness = 1.0;  // of every numerical substructure's forces
  double damping = 1.0;    // of the structure
  double step = 1.0;       // of the integrator
};

/// The list under the optional key `effects` of a scenario.
[[nodiscard]] NumericalErrors read_numerical_errors(config::Section& scenario);

}  // namespace hybridtest
