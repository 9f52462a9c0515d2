#include "validation/design_motion/oscillator.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace hybridtest::design_motion {
namespace {

constexpr double kInstantsPerPeriod = 40.0;

}  // namespace

Oscillator::Oscillator(double period_s, double damping_ratio, double dt_s) noexcept
    : omega_{2.0 * std::numbers::pi / period_s}, ratio_{damping_ratio}, dt_s_{dt_s} {
  const double damped = omega_ * std::sqrt(1.0 - ratio_ * ratio_);
  const double decay = std::exp(-ratio_ * omega_ * dt_s);
  const double sine = decay * std::sin(damped * dt_s);
  const double cosine = decay * std::cos(damped * dt_s);
  displacement_of_displacement_ = cosine + ratio_ * omega_ / damped * sine;
  displacement_of_velocity_ = sine / damped;
  velocity_of_displacement_ = -omega_ * omega_ / damped * sine;
  velocity_of_velocity_ = cosine - ratio_ * omega_ / damped * sine;
}

void Oscillator::advance(double begin, double end) noexcept {
  // Under a ramp the oscillator follows a straight line once free vibration has died out.
  const double slope = (end - begin) / dt_s_;
  const double square = omega_ * omega_;
  const double line_begin = -begin / square + 2.0 * ratio_ * slope / (square * omega_);
  const double line_velocity = -slope / square;
  const double free_displacement = displacement_m_ - line_begin;
  const double free_velocity = velocity_m_per_s_ - line_velocity;
  displacement_m_ = displacement_of_displacement_ * free_displacement + displacement_of_velocity_ * free_velocity +
                    line_begin + line_velocity * dt_s_;
  velocity_m_per_s_ =
      velocity_of_displacement_ * free_displacement + velocity_of_velocity_ * free_velocity + line_velocity;
}

PeakResponse peak_response(const std::vector<double>& acceleration_m_per_s2, double dt_s, double period_s,
                           double damping_ratio) noexcept {
  const int parts = static_cast<int>(std::ceil(std::max(1.0, kInstantsPerPeriod * dt_s / period_s)));
  Oscillator oscillator{period_s, damping_ratio, dt_s / parts};
  const double square = oscillator.frequency_rad_per_s() * oscillator.frequency_rad_per_s();
  PeakResponse peak;
  for (std::size_t i = 0; i + 1 < acceleration_m_per_s2.size(); ++i) {
    const double begin = acceleration_m_per_s2[i];
    const double rise = (acceleration_m_per_s2[i + 1] - begin) / parts;
    for (int part = 0; part < parts; ++part) {
      oscillator.advance(begin + rise * part, begin + rise * (part + 1));
      const double response = square * oscillator.displacement_m();
      if (std::abs(response) <= std::abs(peak.pseudo_acceleration_m_per_s2)) continue;
      peak = {.pseudo_acceleration_m_per_s2 = response,
              .time_s = dt_s * (static_cast<double>(i) + static_cast<double>(part + 1) / parts)};
    }
  }
  return peak;
}

}  // namespace hybridtest::design_motion
