#pragma once

#include "mechanics/structure/vibration_modes.hpp"

namespace hybridtest {

/// Stability limit of the step of an integrator.
struct StepStability {
  double highest_frequency_rad_per_s = 0.0;  // whose omega dt must not exceed 2
  double step_s_max = 0.0;                   // infinite without a limit
};

/// The integrators without the initial stiffness in their matrices (IntegratorNeeds) are stable while omega dt <= 2,
/// that is dt <= T_n/pi of the highest mode, for any damping that they treat implicitly (Belytschko and Hughes,
/// Computational Methods for Transient Analysis, 1983, chapter 2).
///
/// The limit is that of the initial stiffness: a law that becomes stiffer, and the mass or
/// damping of a specimen, lower it.
[[nodiscard]] StepStability step_stability(const VibrationModes& modes) noexcept;

/// @throws ConfigError when `step_s` is above the limit, with the highest frequency, the limit
///         and the step.
void require_stable_step(const VibrationModes& modes, double step_s);

}  // namespace hybridtest
