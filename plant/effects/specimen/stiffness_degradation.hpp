#pragma once

#include <array>
#include <cmath>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// The specimen gets softer the further it has travelled (Baber and Wen, J. Eng. Mech. Div. ASCE 107, 1981,
/// whose eta grows with the dissipated energy; the path is what a specimen without hysteresis has):
/// its law sees a displacement that shrinks by a half once it has travelled L. A law that yields keeps
/// its strength.
class StiffnessDegradation final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0(x / (1 + S / L)), S = travelled path";
  static constexpr std::string_view kSource = "after Baber and Wen (1981)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::degradation};
  static constexpr std::array kParameters{EffectParameter{.name = "half_life_m",
                                                          .unit = "m",
                                                          .what = "L, path after which it is half as stiff",
                                                          .low = 1e-9,
                                                          .high = kUnbounded,
                                                          .neutral = kUnbounded}};

  StiffnessDegradation(std::span<const double> values, double /*sample_period_s*/) : half_life_m_{values[0]} {}
  void before(const StageSample& sample, Motion& motion) noexcept override {
    path_m_ += std::abs(sample.motion.displacement_m - displacement_m_);
    displacement_m_ = sample.motion.displacement_m;
    const double left = 1.0 / (1.0 + path_m_ / half_life_m_);
    motion.displacement_m *= left;
    motion.velocity_m_per_s *= left;
  }
  void reset() noexcept override { path_m_ = displacement_m_ = 0.0; }

 private:
  double half_life_m_;
  double path_m_ = 0.0;
  double displacement_m_ = 0.0;
};

}  // namespace hybridtest
