#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "launch/design_motion/filtered_noise.hpp"

namespace hybridtest::design_motion {

/// What the tool can be asked for.
struct DesignMotionSettings {
  std::uint64_t seed = 1;
  /// a_g on rock, in g: a region of high seismicity in southern Europe.
  double ground_acceleration_g = 0.25;
  double dt_s = 0.005;
  double duration_s = 31.0;
  int iterations = 30;
};

/// An artificial accelerogram fitted to the Eurocode 8 type 1 elastic spectrum, ground C, 5 percent
/// damping (EN 1998-1:2004, 3.2.3.1.2): filtered noise under an envelope with twelve seconds of
/// strong motion, spectrum-matched from 0.02 to 5 s, without residual velocity or displacement,
/// and with a peak of at least a_g S. The same settings give the same numbers.
///
/// @return acceleration [m/s2], the first sample at time 0.
/// @throws ConfigError for a step outside [0.001, 0.02] s, a duration outside [25, 120] s, an
///         acceleration outside (0, 2] g, iterations outside 0 to 1000.
[[nodiscard]] std::vector<double> design_motion(const DesignMotionSettings& settings);

/// The motion as a PEER AT2 file, in g, five values of eight digits per line.
[[nodiscard]] std::string at2_text(const std::vector<double>& acceleration_m_per_s2,
                                   const DesignMotionSettings& settings);

}  // namespace hybridtest::design_motion
