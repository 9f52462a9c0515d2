#pragma once

#include <cstdint>
#include <string>

namespace hybridtest {

/// Standard gravity, exact by definition.
inline constexpr double kStandardGravity_m_per_s2 = 9.80665;

/// The damping ratio that design codes draw response spectra for.
inline constexpr double kSpectrumDamping = 0.05;

/// What a check and a summary say of a ground motion, so that a wrong unit or scale shows before the response does.
struct GroundMotionFacts {
  double peak_m_per_s2 = 0.0;  // largest magnitude, scaled
  std::int64_t points = 0;     // of the file
  double duration_s = 0.0;     // to the last of them
};

/// `peak 0.3569 g (3.5 m/s2), 6201 points, 31 s`.
[[nodiscard]] std::string ground_motion_text(const GroundMotionFacts& motion);

/// A warning where the peak is below 0.01 g or above 3 g, which is hardly an earthquake: values in g that are read as
/// m/s2 are a tenth, and the other way round ten times too large. Empty for a plausible peak.
[[nodiscard]] std::string ground_motion_warning(const GroundMotionFacts& motion);

}  // namespace hybridtest
