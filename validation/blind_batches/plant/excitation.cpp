#include <algorithm>
#include <cmath>
#include <numbers>

#include "validation/blind_batches/plant/blind_case.hpp"

namespace hybridtest::blind {

namespace {

/// Highest frequency of a motion: above it the straight lines between samples would be visible.
constexpr double kFrequency_hz_max = 12.0;

double highest_hz(const ExcitationSettings& settings, double share) {
  return std::min(kFrequency_hz_max, share * settings.velocity_m_per_s / (kTwoPi * settings.stroke_m));
}

/// Oscillator under white noise below an envelope (Jennings, Housner and Tsai, 1968), by
/// semi-implicit Euler. Its displacement is the motion of a storey.
History earthquake(const ExcitationSettings& settings, std::size_t samples, RandomStream& random) {
  const double period_s = 1.0 / settings.rate_hz / 8.0;
  const double omega = kTwoPi * std::min(highest_hz(settings, 0.8), random.log_uniform(0.5, 3.0));
  const double damping = random.uniform(0.03, 0.12);
  const double length_s = static_cast<double>(samples) / settings.rate_hz;
  const double rise_s = random.uniform(0.1, 0.25) * length_s;
  const double strong_s = random.uniform(0.3, 0.5) * length_s;
  const double decay_per_s = random.uniform(3.0, 5.0) / (length_s - strong_s);
  History motion(samples);
  double x = 0.0;
  double v = 0.0;
  double ground = 0.0;  // white noise under a corner of 6 Hz
  for (std::size_t i = 0; i < samples * 8; ++i) {
    const double t = static_cast<double>(i) * period_s;
    double envelope = std::min(1.0, (t / rise_s) * (t / rise_s));
    if (t > strong_s) envelope *= std::exp(-decay_per_s * (t - strong_s));
    ground += kTwoPi * 6.0 * period_s * (random.normal() / std::sqrt(period_s) - ground);
    v += period_s * (envelope * ground - 2.0 * damping * omega * v - omega * omega * x);
    x += period_s * v;
    if (i % 8 == 0) motion[i / 8] = x;
  }
  return motion;
}

History sweep(const ExcitationSettings& settings, std::size_t samples, RandomStream& random) {
  const double length_s = static_cast<double>(samples) / settings.rate_hz;
  const double low_hz = random.log_uniform(0.15, 0.4);
  const double steady_hz = std::max(low_hz, highest_hz(settings, 1.0));
  const double high_hz = std::min(kFrequency_hz_max, steady_hz * random.uniform(2.0, 6.0));
  const double rate = std::log(high_hz / low_hz);
  History motion(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(samples);
    const double frequency_hz = low_hz * std::exp(rate * share);
    const double phase = kTwoPi * low_hz * length_s / rate * (std::exp(rate * share) - 1.0);
    // At constant velocity if the stroke would require a higher one.
    motion[i] = std::min(1.0, steady_hz / frequency_hz) * std::sin(phase);
  }
  return motion;
}

History growing_sinusoid(const ExcitationSettings& settings, std::size_t samples, RandomStream& random) {
  const double frequency_hz = std::min(highest_hz(settings, 1.0), random.log_uniform(0.3, 3.0));
  const double power = random.uniform(0.7, 1.5);
  History motion(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) / settings.rate_hz;
    motion[i] =
        std::pow(static_cast<double>(i) / static_cast<double>(samples), power) * std::sin(kTwoPi * frequency_hz * t);
  }
  return motion;
}

/// Cycles of stepwise larger amplitude, each amplitude two or three times (as FEMA 461).
History protocol(const ExcitationSettings& settings, std::size_t samples, RandomStream& random) {
  const double length_s = static_cast<double>(samples) / settings.rate_hz;
  const double wanted_hz = std::min(highest_hz(settings, 1.0), random.log_uniform(0.4, 2.0));
  const std::size_t repeats = 2 + random.index(2);
  const auto cycles = static_cast<double>(
      std::max<std::size_t>(2, static_cast<std::size_t>(wanted_hz * length_s / static_cast<double>(repeats))) *
      repeats);
  const double steps = cycles / static_cast<double>(repeats);
  History motion(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    const double cycle = cycles * static_cast<double>(i) / static_cast<double>(samples);
    const double amplitude = (1.0 + std::floor(cycle / static_cast<double>(repeats))) / steps;
    motion[i] = amplitude * std::sin(kTwoPi * cycle);
  }
  return motion;
}

History band_noise(const ExcitationSettings& settings, std::size_t samples, RandomStream& random) {
  constexpr std::size_t kTones = 60;
  const double low_hz = random.log_uniform(0.1, 0.4);
  const double high_hz = std::max(2.0 * low_hz, highest_hz(settings, random.uniform(0.6, 1.6)));
  History motion(samples, 0.0);
  for (std::size_t tone = 0; tone < kTones; ++tone) {
    const double frequency_hz = random.uniform(low_hz, high_hz);
    const double phase = random.uniform(0.0, kTwoPi);
    for (std::size_t i = 0; i < samples; ++i) {
      motion[i] += std::sin(kTwoPi * frequency_hz * static_cast<double>(i) / settings.rate_hz + phase);
    }
  }
  return motion;
}

/// Raised cosine over the first and last `length` samples.
void taper(History& motion, std::size_t length) {
  for (std::size_t i = 0; i < length; ++i) {
    const double weight = 0.5 - 0.5 * std::cos(std::numbers::pi * static_cast<double>(i) / static_cast<double>(length));
    motion[i] *= weight;
    motion[motion.size() - 1 - i] *= weight;
  }
}

}  // namespace

History draw_excitation(const ExcitationSettings& settings, RandomStream& random) {
  using Draw = History (*)(const ExcitationSettings&, std::size_t, RandomStream&);
  static const std::vector<Draw> kDraws{earthquake, sweep, growing_sinusoid, protocol, band_noise};
  const auto total = static_cast<std::size_t>(settings.duration_s * settings.rate_hz) + 1;
  const auto rest = static_cast<std::size_t>(settings.rest_s * settings.rate_hz);
  const std::size_t moving = total - 2 * rest;
  History motion = kDraws[random.weighted({0.4, 0.15, 0.12, 0.13, 0.2})](settings, moving, random);
  taper(motion, static_cast<std::size_t>(0.4 * settings.rate_hz));
  const double factor = settings.stroke_m / peak(motion);
  History history(total, 0.0);
  for (std::size_t i = 0; i < moving; ++i) history[rest + i] = factor * motion[i];
  return history;
}

}  // namespace hybridtest::blind
