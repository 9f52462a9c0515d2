#include "launch/design_motion/design_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <utility>

#include "coordinator/ground_motion/read_ground_motion.hpp"
#include "core/config/error.hpp"
#include "core/random.hpp"
#include "launch/design_motion/baseline.hpp"
#include "launch/design_motion/elastic_spectrum.hpp"
#include "launch/design_motion/spectral_matching.hpp"

namespace hybridtest::design_motion {
namespace {

/// Matched: beyond both ends of what the code asks of a structure, so that the ends hold.
constexpr double kFirstPeriod_s = 0.02;
constexpr double kLastPeriod_s = 10.0;
constexpr int kPeriods = 160;
constexpr double kFade_s = 0.5;

void require(bool is_valid, const char* what) {
  if (!is_valid) throw ConfigError{what};
}

SpectralTarget target_of(const ElasticSpectrum& spectrum) {
  SpectralTarget target;
  target.damping_ratio = spectrum.damping_ratio;
  target.period_s = logarithmic_periods(kFirstPeriod_s, kLastPeriod_s, kPeriods);
  for (const double period_s : target.period_s) target.pseudo_acceleration_m_per_s2.push_back(spectrum.at(period_s));
  return target;
}

double peak(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

void scale(std::vector<double>& values, double factor) {
  for (double& value : values) value *= factor;
}

}  // namespace

std::vector<double> design_motion(const DesignMotionSettings& settings) {
  require(settings.dt_s >= 0.001 && settings.dt_s <= 0.02, "the step is out of range, expected 0.001 to 0.02 s");
  require(settings.duration_s >= 25.0 && settings.duration_s <= 120.0,
          "the duration is out of range, expected 25 to 120 s");
  require(settings.ground_acceleration_g > 0.0 && settings.ground_acceleration_g <= 2.0,
          "the ground acceleration is out of range, expected above 0 to 2 g");
  require(settings.iterations >= 0 && settings.iterations <= 1000, "expected 0 to 1000 iterations");

  const auto spectrum = ElasticSpectrum::type_1_ground_c(settings.ground_acceleration_g * kStandardGravity_m_per_s2);
  Envelope envelope;
  envelope.end_s = settings.duration_s;
  Random random{settings.seed};
  const auto count = static_cast<std::size_t>(std::lround(settings.duration_s / settings.dt_s)) + 1;
  std::vector<double> motion = filtered_noise(random, GroundFilter{}, envelope, settings.dt_s, count);
  remove_drift(motion, settings.dt_s);
  scale(motion, spectrum.zero_period_m_per_s2() / peak(motion));
  motion = match_spectrum(std::move(motion), settings.dt_s, target_of(spectrum), kFade_s, settings.iterations);
  // 3.2.3.1.2(4)b: the zero-period response, of a single motion its peak, is not below a_g S.
  scale(motion, std::max(1.0, spectrum.zero_period_m_per_s2() / peak(motion)));
  return motion;
}

std::string at2_text(const std::vector<double>& acceleration_m_per_s2, const DesignMotionSettings& settings) {
  char line[128];
  std::string text = "ARTIFICIAL DESIGN MOTION, FILTERED NOISE MATCHED TO A SPECTRUM\n";
  std::snprintf(line, sizeof line, "EUROCODE 8 TYPE 1, GROUND C, 5 PERCENT DAMPING, AG = %.4g G, SEED %llu\n",
                settings.ground_acceleration_g, static_cast<unsigned long long>(settings.seed));
  text += line;
  text += "ACCELERATION TIME HISTORY IN UNITS OF G\n";
  std::snprintf(line, sizeof line, "NPTS= %6zu, DT= %.5f SEC\n", acceleration_m_per_s2.size(), settings.dt_s);
  text += line;
  constexpr std::size_t kPerLine = 5;
  for (std::size_t i = 0; i < acceleration_m_per_s2.size(); ++i) {
    std::snprintf(line, sizeof line, "%15.7E", acceleration_m_per_s2[i] / kStandardGravity_m_per_s2);
    text += line;
    const bool ends_line = (i + 1) % kPerLine == 0 || i + 1 == acceleration_m_per_s2.size();
    if (ends_line) text += '\n';
  }
  return text;
}

}  // namespace hybridtest::design_motion
