#pragma once

#include <vector>

#include "validation/studies/compensation_methods.hpp"

namespace hybridtest::character {

/// Damping ratio of a structure of one degree of freedom whose whole stiffness is tested with a delayed actuator,
/// measured on its free vibration: the slope of the logarithm of its amplitude. Explicit Newmark at 1 kHz,
/// delay of 20 ms; the method receives the exact delay.
///
/// The closed form without compensation is the root s of s^2 + 2 zeta omega s + omega^2 exp(-s delay) = 0.
/// @param omega_delay   natural angular frequency times delay [rad].
/// @param damping       of the structure itself, as a ratio.
/// @return minus the growth rate over omega; negative where the motion grows.
[[nodiscard]] double measured_loop_damping(const CompensationMethod& method, double omega_delay, double damping);

/// The smallest omega delay at which the motion neither grows nor decays, interpolated linearly between the last value
/// at which it decays and the first at which it grows; the last value if it never grows.
/// @param omega_delays   rising. @param dampings   at each.
struct StabilityLimit {
  double omega_delay = 0.0;
  bool is_reached = false;
};
[[nodiscard]] StabilityLimit stability_limit(const std::vector<double>& omega_delays,
                                             const std::vector<double>& dampings);

}  // namespace hybridtest::character
