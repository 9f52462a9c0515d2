#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <numbers>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// A spring-pot beside the model's law: between a spring (order 0) and a dashpot (order 1), as rubber and high-damping
/// bearings are (Koh and Kelly, Earthquake Engng Struct. Dyn. 19, 1990). Its stiffness grows with the frequency f in Hz
/// as f^a, and its loss factor is tan(a pi / 2) at each. At rest before the recording.
///
/// Caputo's derivative as an integral over fading springs, t^-a / Gamma(1-a) = sin(a pi) / pi * integral of s^a exp(-s
/// t) d(ln s), by the midpoint rule at two of them a decade (error 4e-4 of the force; Yuan and Agrawal, J. Vib. Acoust.
/// 124, 2002). Exact for motions that run straight from sample to sample; what fades slower than the slowest is a
/// spring, what fades faster than the fastest a dashpot.
class FractionalDamping final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + k D^a x / (2 pi 1 Hz)^a";
  static constexpr std::string_view kSource = "Koh and Kelly (1990)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::rate, .needs_time = true};
  static constexpr std::array kParameters{EffectParameter{.name = "stiffness_n_per_m",
                                                          .unit = "N/m",
                                                          .what = "k, size of the complex stiffness at 1 Hz",
                                                          .low = -kUnbounded,
                                                          .high = kUnbounded,
                                                          .is_linear = true},
                                          EffectParameter{.name = "order",
                                                          .unit = "",
                                                          .what = "a, 0: spring, 1: dashpot",
                                                          .low = 0.01,
                                                          .high = 0.99,
                                                          .neutral = kNoNeutral}};

  FractionalDamping(std::span<const double> values, double sample_period_s) {
    const double order = values[1];
    const double scale_n_per_m =
        values[0] * std::pow(2.0 * std::numbers::pi, -order) * std::sin(order * std::numbers::pi) / std::numbers::pi;
    const double step = 0.5 * std::numbers::ln10;  // of ln s
    double log_rate = std::log(10.0 / sample_period_s);
    dashpot_n_per_m_ =
        scale_n_per_m * std::exp((order - 1.0) * (log_rate + 0.5 * step)) / (1.0 - order) / sample_period_s;
    for (Eigen::Index i = 0; i < kFadingSprings; ++i) {
      const double turn = std::exp(log_rate) * sample_period_s;
      stiffness_n_per_m_[i] = scale_n_per_m * step * std::exp(order * log_rate);
      decay_[i] = std::exp(-turn);
      share_[i] = -std::expm1(-turn) / turn;
      log_rate -= step;
    }
    spring_n_per_m_ = scale_n_per_m * std::exp(order * (log_rate + 0.5 * step)) / order;
  }
  void after(const StageSample& sample, const Motion& /*motion*/, double& force_n) noexcept override {
    const double travel_m = sample.motion.displacement_m - displacement_m_;
    displacement_m_ = sample.motion.displacement_m;
    force_n += spring_n_per_m_ * displacement_m_ + dashpot_n_per_m_ * travel_m;
    stretch_m_ = decay_ * stretch_m_ + share_ * travel_m;
    force_n += (stiffness_n_per_m_ * stretch_m_).sum();
  }
  void reset() noexcept override {
    displacement_m_ = 0.0;
    stretch_m_.setZero();
  }

 private:
  // From a tenth of a sample down to 3e8 samples.
  static constexpr Eigen::Index kFadingSprings = 20;
  using OfSprings = Eigen::Array<double, kFadingSprings, 1>;

  OfSprings stiffness_n_per_m_;
  OfSprings decay_;  // of its stretch over a sample
  OfSprings share_;  // of a sample's travel that is left at its end
  OfSprings stretch_m_ = OfSprings::Zero();
  double spring_n_per_m_;
  double dashpot_n_per_m_;  // over a sample
  double displacement_m_ = 0.0;
};

}  // namespace hybridtest
