#pragma once

#include <optional>
#include <span>

namespace hybridtest {

/// Root mean square of the noise in a remainder, by its spectrum. Where the output shows nothing of the motion, as at
/// high frequencies, all of the remainder is noise. Where it does, a gap may be part of the remainder, and the noise is
/// at most what an autoregressive process of first order beside white noise has there that fits the high frequencies
/// (Whittle's likelihood: Arkiv för Matematik 2, 1953). Lines of hum are left out of that fit.
/// @param measured    output; @param remainder   what no model and no function of the motion explains of it.
/// @return            nothing where the motion, or what goes with it, fills the frequencies.
[[nodiscard]] std::optional<double> noise_by_spectrum(std::span<const double> measured,
                                                      std::span<const double> remainder, double period_s);

}  // namespace hybridtest
