#pragma once

#include <complex>
#include <vector>

#include "validation/studies/compensation_methods.hpp"
#include "validation/studies/compensator_character/test_stand.hpp"

namespace hybridtest::character {

/// The force that the structure receives over the force that belongs to the target: 1 when compensation is exact.
/// For compensators on commands only, this is actual over target displacement.
///
/// Measured, not computed, so that adaptive methods are measured after they have settled: a sine of 3 mm that begins
/// smoothly, time to settle, least squares of sine and cosine over whole cycles. Not finite where a method diverges.
[[nodiscard]] std::complex<double> measured_response(const CompensationMethod& method, const StandKind& stand,
                                                     double frequency_hz);

/// Delay in s; from -1/2 to 1/2 of a cycle.
[[nodiscard]] double effective_delay_s(std::complex<double> response, double frequency_hz);

/// Evenly spaced on a logarithmic scale. @param count   at least 2.
[[nodiscard]] std::vector<double> logarithmic_frequencies(double low_hz, double high_hz, int count);

}  // namespace hybridtest::character
