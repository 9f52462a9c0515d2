#pragma once

#include <array>
#include <cmath>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Damping with a power of the velocity beside the model's law, as of a fluid damper whose orifices open under pressure
/// (Seleemah and Constantinou, NCEER-97-0004, 1997); as the law Viscous.
class NonlinearViscousDamping final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + c sign(v) |v|^n";
  static constexpr std::string_view kSource = "Seleemah and Constantinou (1997)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::rate, .follows_derivatives = true, .needs_time = true};
  static constexpr std::array kParameters{
      EffectParameter{.name = "damping_n_s_per_m",
                      .unit = "N (s/m)ⁿ",
                      .what = "c, the force at 1 m/s",
                      .low = -kUnbounded,
                      .high = kUnbounded,
                      .is_linear = true},
      EffectParameter{
          .name = "exponent", .unit = "", .what = "n, 1: linear", .low = 0.1, .high = 3.0, .neutral = kNoNeutral}};

  NonlinearViscousDamping(std::span<const double> values, double /*sample_period_s*/)
      : damping_n_s_per_m_{values[0]}, exponent_{values[1]} {}
  void after(const StageSample& sample, const Motion& /*motion*/, double& force_n) noexcept override {
    const double velocity = sample.motion.velocity_m_per_s;
    force_n += damping_n_s_per_m_ * std::copysign(std::pow(std::abs(velocity), exponent_), velocity);
  }
  void reset() noexcept override {}

 private:
  double damping_n_s_per_m_;
  double exponent_;
};

}  // namespace hybridtest
