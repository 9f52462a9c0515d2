#pragma once

#include <array>
#include <cmath>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Spring and dashpot in series beside the model's law: a force that fades at rest (Maxwell, Phil. Trans. 157,
/// 1867). Exact for motions that run straight from sample to sample.
class Relaxation final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + f, f' + f / T = k v";
  static constexpr std::string_view kSource = "Maxwell (1867)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::rate, .needs_time = true};
  static constexpr std::array kParameters{EffectParameter{.name = "stiffness_n_per_m",
                                                          .unit = "N/m",
                                                          .what = "k, of a sudden motion",
                                                          .low = -kUnbounded,
                                                          .high = kUnbounded,
                                                          .is_linear = true},
                                          EffectParameter{.name = "time_constant_s",
                                                          .unit = "s",
                                                          .what = "T, of the fading",
                                                          .low = 1e-9,
                                                          .high = kUnbounded,
                                                          .neutral = kNoNeutral}};

  Relaxation(std::span<const double> values, double sample_period_s)
      : stiffness_n_per_m_{values[0]},
        decay_{std::exp(-sample_period_s / values[1])},
        share_{-std::expm1(-sample_period_s / values[1]) * values[1] / sample_period_s} {}
  void after(const StageSample& sample, const Motion& /*motion*/, double& force_n) noexcept override {
    const double travel_m = sample.motion.displacement_m - displacement_m_;
    displacement_m_ = sample.motion.displacement_m;
    stretch_m_ = decay_ * stretch_m_ + share_ * travel_m;
    force_n += stiffness_n_per_m_ * stretch_m_;
  }
  void reset() noexcept override { stretch_m_ = displacement_m_ = 0.0; }

 private:
  double stiffness_n_per_m_;
  double decay_;
  double share_;  // of a sample's travel that is left at its end
  double stretch_m_ = 0.0;
  double displacement_m_ = 0.0;
};

}  // namespace hybridtest
