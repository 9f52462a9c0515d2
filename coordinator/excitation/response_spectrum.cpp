#include "coordinator/excitation/response_spectrum.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace hybridtest {
namespace {

constexpr double kStepsPerPeriod = 100.0;
constexpr int kPeriods = 101;
constexpr double kPeriod_s_min = 0.02;
constexpr double kPeriod_s_max = 10.0;

/// One step of an oscillator under a load that changes linearly, in units of the step: x = [u, h u', h^2 a, h^2 da],
/// with da the change of the acceleration of the ground over the step.
class OscillatorStep {
 public:
  OscillatorStep(double omega_rad_per_s, double damping_ratio, double step_s) : step_s_{step_s} {
    const double angle = omega_rad_per_s * step_s;
    Eigen::Matrix4d rate = Eigen::Matrix4d::Zero();
    rate(0, 1) = 1.0;
    rate.row(1) << -angle * angle, -2.0 * damping_ratio * angle, -1.0, 0.0;
    rate(2, 3) = 1.0;
    // The entries of `rate` are at most 1 for sensible damping: twenty terms leave 1e-18.
    constexpr int kTerms = 24;
    Eigen::Matrix4d whole = Eigen::Matrix4d::Identity();
    Eigen::Matrix4d term = whole;
    for (int k = 1; k <= kTerms; ++k) {
      term = rate * term / static_cast<double>(k);
      whole += term;
    }
    from_state_ = whole.topLeftCorner<2, 2>();
    from_load_ = whole.topRightCorner<2, 2>() * (step_s * step_s);
  }

  void advance(double acceleration_m_per_s2, double next_m_per_s2) noexcept {
    state_ = from_state_ * state_ +
             from_load_ * Eigen::Vector2d{acceleration_m_per_s2, next_m_per_s2 - acceleration_m_per_s2};
    displacement_m_ = std::max(displacement_m_, std::abs(state_[0]));
    velocity_m_per_s_ = std::max(velocity_m_per_s_, std::abs(state_[1]) / step_s_);
  }
  /// Largest so far.
  [[nodiscard]] double displacement_m() const noexcept { return displacement_m_; }
  [[nodiscard]] double velocity_m_per_s() const noexcept { return velocity_m_per_s_; }

 private:
  double step_s_;
  Eigen::Matrix2d from_state_;
  Eigen::Matrix2d from_load_;
  Eigen::Vector2d state_ = Eigen::Vector2d::Zero();  // [u, h u']
  double displacement_m_ = 0.0;
  double velocity_m_per_s_ = 0.0;
};

}  // namespace

SpectrumOrdinate spectrum_ordinate(const GroundMotion& motion, double period_s, double damping_ratio) {
  std::span<const double> ground = motion.acceleration_m_per_s2;
  // A long test after a short motion costs nothing: the free vibration is looked at below.
  while (ground.size() > 1 && ground[ground.size() - 1] == 0.0 && ground[ground.size() - 2] == 0.0)
    ground = ground.first(ground.size() - 1);
  const double omega = 2.0 * std::numbers::pi / period_s;
  const int parts = std::max(1, static_cast<int>(std::ceil(kStepsPerPeriod * motion.dt_s / period_s)));
  const double step_s = motion.dt_s / parts;
  OscillatorStep oscillator{omega, damping_ratio, step_s};
  for (std::size_t i = 0; i + 1 < ground.size(); ++i) {
    const double slope = (ground[i + 1] - ground[i]) / parts;
    for (int part = 0; part < parts; ++part) {
      oscillator.advance(ground[i] + slope * part, ground[i] + slope * (part + 1));
    }
  }
  const auto free_steps = static_cast<std::int64_t>(std::ceil(period_s / step_s));
  for (std::int64_t i = 0; i < free_steps; ++i) oscillator.advance(0.0, 0.0);
  return {.period_s = period_s,
          .displacement_m = oscillator.displacement_m(),
          .velocity_m_per_s = oscillator.velocity_m_per_s(),
          .pseudo_acceleration_m_per_s2 = omega * omega * oscillator.displacement_m()};
}

std::vector<double> spectrum_periods_s() {
  std::vector<double> periods_s;
  for (int i = 0; i < kPeriods; ++i) {
    periods_s.push_back(kPeriod_s_min *
                        std::pow(kPeriod_s_max / kPeriod_s_min, static_cast<double>(i) / (kPeriods - 1)));
  }
  return periods_s;
}

std::vector<SpectrumOrdinate> response_spectrum(const GroundMotion& motion, std::span<const double> periods_s,
                                                double damping_ratio) {
  std::vector<SpectrumOrdinate> ordinates;
  for (const double period_s : periods_s) ordinates.push_back(spectrum_ordinate(motion, period_s, damping_ratio));
  return ordinates;
}

}  // namespace hybridtest
