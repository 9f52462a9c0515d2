#pragma once

#include <vector>

namespace hybridtest::design_motion {

/// Velocity at each sample, from rest; exact for accelerations that are linear between their samples.
[[nodiscard]] std::vector<double> velocity_m_per_s(const std::vector<double>& acceleration_m_per_s2, double dt_s);
/// Displacement at each sample, likewise.
[[nodiscard]] std::vector<double> displacement_m(const std::vector<double>& acceleration_m_per_s2, double dt_s);

/// Adds the two smooth, motion-long accelerations, sin^2(pi t/T) and the same times t/T, that bring
/// velocity and displacement to zero at the end. Their periods are far above those of structures.
/// @param acceleration_m_per_s2   at least four samples.
void remove_drift(std::vector<double>& acceleration_m_per_s2, double dt_s);

}  // namespace hybridtest::design_motion
