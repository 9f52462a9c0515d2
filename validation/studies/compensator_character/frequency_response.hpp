#pragma once

#include <complex>
#include <vector>

#include "validation/studies/compensation_methods.hpp"
#include "validation/studies/compensator_character/test_stand.hpp"

namespace hybridtest::character {

/// From the target's force, that which the specimen ought to have, to the force that the structure gets: 1 where
/// compensation is perfect. For compensators on commands alone this is actual over target displacement.
///
/// Measured, not computed, so that adaptive methods are what they have become: a sine of 3 mm that begins smoothly,
/// time to settle, least squares of sine and cosine over whole cycles. Not finite where a method has run away.
[[nodiscard]] std::complex<double> measured_response(const CompensationMethod& method, const StandKind& stand,
                                                     double frequency_hz);

/// How late, in s; from -1/2 to 1/2 of a cycle.
[[nodiscard]] double effective_delay_s(std::complex<double> response, double frequency_hz);

/// Equal steps of the logarithm. @param count   at least 2.
[[nodiscard]] std::vector<double> logarithmic_frequencies(double low_hz, double high_hz, int count);

}  // namespace hybridtest::character
