#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "validation/design_motion/elastic_spectrum.hpp"
#include "validation/design_motion/spectral_matching.hpp"

namespace hybridtest::design_motion {

/// The settings of the tool.
struct DesignMotionSettings {
  std::uint64_t seed = 1;
  /// a_g on rock, in g: a region of high seismicity in southern Europe.
  double ground_acceleration_g = 0.25;
  double dt_s = 0.005;
  double duration_s = 31.0;
  int iterations = 20;
};

/// A motion and the quality of its fit.
struct DesignMotion {
  std::vector<double> acceleration_m_per_s2;  // the first sample at time 0
  SpectralFit fit;                            // from 0.05 to 4 s, on a grid finer than the one matched
};

/// The target spectrum of the settings.
[[nodiscard]] ElasticSpectrum design_spectrum(const DesignMotionSettings& settings) noexcept;

/// The spectrum at `count` periods from `first_s` to `last_s`.
[[nodiscard]] SpectralTarget spectral_target(const ElasticSpectrum& spectrum, double first_s, double last_s, int count);

/// An artificial accelerogram fitted to the Eurocode 8 type 1 elastic spectrum, ground C, 5 percent
/// damping (EN 1998-1:2004, 3.2.3.1.2): filtered noise under an envelope with twelve seconds of
/// strong motion, matched to the spectrum from 0.02 to 10 s, without residual velocity or
/// displacement, and with a peak of at least a_g S. Of up to twelve realisations of the noise, the
/// first that comes within 8 percent of the spectrum from 0.05 to 4 s, otherwise the closest.
/// The same settings give the same numbers.
///
/// @throws ConfigError for a step outside [0.001, 0.02] s, a duration outside [25, 120] s, an
///         acceleration outside (0, 2] g, iterations outside 0 to 1000.
[[nodiscard]] DesignMotion design_motion(const DesignMotionSettings& settings);

/// The motion as a PEER AT2 file, in g, eight values of six decimals per line.
[[nodiscard]] std::string at2_text(const std::vector<double>& acceleration_m_per_s2,
                                   const DesignMotionSettings& settings);

}  // namespace hybridtest::design_motion
