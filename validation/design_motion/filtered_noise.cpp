#include "validation/design_motion/filtered_noise.hpp"

#include <cmath>
#include <numbers>

#include "validation/design_motion/oscillator.hpp"

namespace hybridtest::design_motion {
namespace {

/// The filters run for this time before the motion starts, so that their noise is stationary.
constexpr double kSettling_s = 10.0;

double damping_term(const Oscillator& oscillator, double ratio) {
  return 2.0 * ratio * oscillator.frequency_rad_per_s() * oscillator.velocity_m_per_s();
}

double stiffness_term(const Oscillator& oscillator) {
  return oscillator.frequency_rad_per_s() * oscillator.frequency_rad_per_s() * oscillator.displacement_m();
}

}  // namespace

double Envelope::at(double time_s) const noexcept {
  if (time_s <= 0.0 || time_s >= end_s) return 0.0;
  double strength = 1.0;
  if (time_s < rise_s) strength = (time_s / rise_s) * (time_s / rise_s);
  if (time_s > strong_end_s) strength = std::exp(-decay_per_s * (time_s - strong_end_s));
  const double left_s = end_s - time_s;
  if (left_s < fade_s) strength *= 0.5 * (1.0 - std::cos(std::numbers::pi * left_s / fade_s));
  return strength;
}

std::vector<double> filtered_noise(Random& random, const GroundFilter& filter, const Envelope& envelope, double dt_s,
                                   std::size_t count) {
  Oscillator soil{2.0 * std::numbers::pi / filter.soil_frequency_rad_per_s, filter.soil_damping_ratio, dt_s};
  Oscillator high_pass{2.0 * std::numbers::pi / filter.high_pass_frequency_rad_per_s, filter.high_pass_damping_ratio,
                       dt_s};
  const auto settling = static_cast<std::size_t>(kSettling_s / dt_s);
  std::vector<double> motion;
  motion.reserve(count);
  double rock = 0.0;
  double surface = 0.0;
  for (std::size_t i = 0; i < settling + count; ++i) {
    const double next_rock = random.normal();
    soil.advance(rock, next_rock);
    rock = next_rock;
    // Absolute acceleration of the top of the soil; relative acceleration of the second mass.
    const double next_surface = -damping_term(soil, filter.soil_damping_ratio) - stiffness_term(soil);
    high_pass.advance(surface, next_surface);
    surface = next_surface;
    const double filtered =
        surface + damping_term(high_pass, filter.high_pass_damping_ratio) + stiffness_term(high_pass);
    if (i < settling) continue;
    motion.push_back(filtered * envelope.at(static_cast<double>(i - settling) * dt_s));
  }
  return motion;
}

}  // namespace hybridtest::design_motion
