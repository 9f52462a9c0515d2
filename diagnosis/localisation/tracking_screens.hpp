#pragma once

#include <optional>
#include <span>
#include <vector>

namespace hybridtest {

/// The usual first checks of actuator tracking in the field. They show that there is an error and roughly its
/// kind; none of them shows the cause.

/// Tracking indicator: half the difference between the areas that command against measured
/// displacement encloses seen from either axis (Mercan and Ricles, Earthquake Engineering and
/// Structural Dynamics 36(11), 2007):
///
///   TI = 1/2 (A - TA),  dA = command d(measured),  dTA = measured d(command)   [m2], trapezoidal.
///
/// Grows by pi C M sin(phase) in a cycle of amplitudes C and M: upwards when the measured displacement
/// is behind its command, downwards when it is ahead. One value per sample.
[[nodiscard]] std::vector<double> tracking_indicator_m2(std::span<const double> command_m,
                                                        std::span<const double> measured_m);

/// Hybrid simulation error monitor (Mosqueda, Stojadinovic and Mahin, Journal of Structural Engineering
/// 133(8), 2007): energy that the tracking error adds to the structure,
///
///   E = integral of f d(command) - integral of f d(measured)   [J], trapezoidal,
///
/// negative where the structure gets energy that the specimen did not give, over the largest
/// strain energy 1/2 k command^2 of the recording. One value per sample; all zero at rest.
/// @param stiffness_n_per_m   of the specimen, positive.
[[nodiscard]] std::vector<double> error_monitor(std::span<const double> command_m, std::span<const double> measured_m,
                                                std::span<const double> force_n, double stiffness_n_per_m);

/// Effect of a delayed force on the structure, to first order: damping of -k tau (Horiuchi et al., 1999).
struct DelayConsequence {
  double delay_s = 0.0;
  double stiffness_n_per_m = 0.0;             // secant of the specimen over the recording
  double equivalent_damping_n_s_per_m = 0.0;  // -k tau
  /// The delay at which a structure with this damping at the interface becomes unstable: c / k.
  [[nodiscard]] double critical_delay_s(double structure_damping_n_s_per_m) const noexcept {
    return structure_damping_n_s_per_m / stiffness_n_per_m;
  }
};
/// @return nothing if displacement explains less than half of the force variance (the specimen is not a spring), if
///         the stiffness is not positive, or if the delay cannot be estimated.
[[nodiscard]] std::optional<DelayConsequence> delay_consequence(std::span<const double> command_m,
                                                                std::span<const double> measured_m,
                                                                std::span<const double> force_n, double period_s);

/// Slope of force over displacement by least squares, means left out; 0 at rest.
[[nodiscard]] double secant_stiffness_n_per_m(std::span<const double> displacement_m, std::span<const double> force_n);

}  // namespace hybridtest
