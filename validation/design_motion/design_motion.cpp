#include "validation/design_motion/design_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <utility>

#include "coordinator/excitation/read_ground_motion.hpp"
#include "core/config_error.hpp"
#include "core/random.hpp"
#include "validation/design_motion/baseline.hpp"
#include "validation/design_motion/filtered_noise.hpp"

namespace hybridtest::design_motion {
namespace {

/// Matched: beyond both ends of what the code asks of a structure, so that the ends hold.
constexpr double kFirstMatched_s = 0.02;
constexpr double kLastMatched_s = 10.0;
constexpr int kMatchedPeriods = 240;
/// Checked: where structures are, and finer, so that dips between matched periods count.
constexpr double kFirstChecked_s = 0.05;
constexpr double kLastChecked_s = 4.0;
constexpr int kCheckedPeriods = 500;
constexpr double kGoodMisfit = 0.08;
constexpr std::uint64_t kRealisations = 12;
constexpr double kFade_s = 0.5;

void require(bool is_valid, const char* what) {
  if (!is_valid) throw ConfigError{what};
}

double peak(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

void scale(std::vector<double>& values, double factor) {
  for (double& value : values) value *= factor;
}

void check(const DesignMotionSettings& settings) {
  require(settings.dt_s >= 0.001 && settings.dt_s <= 0.02, "the step is out of range, expected 0.001 to 0.02 s");
  require(settings.duration_s >= 25.0 && settings.duration_s <= 120.0,
          "the duration is out of range, expected 25 to 120 s");
  require(settings.ground_acceleration_g > 0.0 && settings.ground_acceleration_g <= 2.0,
          "the ground acceleration is out of range, expected above 0 to 2 g");
  require(settings.iterations >= 0 && settings.iterations <= 1000,
          "the number of iterations is out of range, expected 0 to 1000");
}

DesignMotion realisation(const DesignMotionSettings& settings, std::uint64_t number) {
  const ElasticSpectrum spectrum = design_spectrum(settings);
  const double dt_s = settings.dt_s;
  Envelope envelope;
  envelope.end_s = settings.duration_s;
  Random random{settings.seed, number};
  const auto count = static_cast<std::size_t>(std::lround(settings.duration_s / dt_s)) + 1;
  std::vector<double> motion = filtered_noise(random, GroundFilter{}, envelope, dt_s, count);
  remove_drift(motion, dt_s);
  scale(motion, spectrum.zero_period_m_per_s2() / peak(motion));
  motion = match_spectrum(std::move(motion), dt_s,
                          spectral_target(spectrum, kFirstMatched_s, kLastMatched_s, kMatchedPeriods), kFade_s,
                          settings.iterations);
  const auto checked = spectral_target(spectrum, kFirstChecked_s, kLastChecked_s, kCheckedPeriods);
  const SpectralFit fit = spectral_fit(motion, dt_s, checked);
  const double centring = 2.0 / (fit.lowest + fit.highest);
  // 3.2.3.1.2(4)b: the zero-period response, of a single motion its peak, is not below a_g S.
  const double factor = std::max(centring, spectrum.zero_period_m_per_s2() / peak(motion));
  scale(motion, factor);
  return {.acceleration_m_per_s2 = std::move(motion),
          .fit = {.lowest = factor * fit.lowest, .highest = factor * fit.highest}};
}

}  // namespace

ElasticSpectrum design_spectrum(const DesignMotionSettings& settings) noexcept {
  return ElasticSpectrum::type_1_ground_c(settings.ground_acceleration_g * kStandardGravity_m_per_s2);
}

SpectralTarget spectral_target(const ElasticSpectrum& spectrum, double first_s, double last_s, int count) {
  SpectralTarget target;
  target.damping_ratio = spectrum.damping_ratio;
  target.period_s = logarithmic_periods(first_s, last_s, count);
  for (const double period_s : target.period_s) target.pseudo_acceleration_m_per_s2.push_back(spectrum.at(period_s));
  return target;
}

DesignMotion design_motion(const DesignMotionSettings& settings) {
  check(settings);
  DesignMotion best;
  for (std::uint64_t number = 0; number < kRealisations; ++number) {
    DesignMotion candidate = realisation(settings, number);
    if (number == 0 || candidate.fit.misfit() < best.fit.misfit()) best = std::move(candidate);
    if (best.fit.misfit() <= kGoodMisfit) break;
  }
  return best;
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
  // Far coarser than what the last bit of another machine's sine leaves after all rounds, so that a
  // seed gives the same text everywhere; far finer than any instrument.
  constexpr std::size_t kPerLine = 8;
  for (std::size_t i = 0; i < acceleration_m_per_s2.size(); ++i) {
    const double rounded = std::round(acceleration_m_per_s2[i] / kStandardGravity_m_per_s2 * 1e6) / 1e6;
    std::snprintf(line, sizeof line, "%10.6f", rounded + 0.0);  // no negative zero
    text += line;
    const bool ends_line = (i + 1) % kPerLine == 0 || i + 1 == acceleration_m_per_s2.size();
    if (ends_line) text += '\n';
  }
  return text;
}

}  // namespace hybridtest::design_motion
