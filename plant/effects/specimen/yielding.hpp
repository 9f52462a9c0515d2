#pragma once

#include <array>

#include "mechanics/laws/giuffre_menegotto_pinto.hpp"
#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Part of the specimen's stiffness yields, which the model takes for elastic: what a spring of stiffness k
/// loses once it yields, without hardening, after Giuffre, Menegotto and Pinto (mechanics). With a large R0
/// the corner is sharp as of a bilinear spring, with a small one round. Nothing is lost before it yields,
/// but for the rounding.
class Yielding final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + G(x) - k x, G: spring of k, Fy, R0 without hardening";
  static constexpr std::string_view kSource = "Menegotto and Pinto (1973)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::amplitude};
  static constexpr std::array kParameters{EffectParameter{.name = "yield_force_n",
                                                          .unit = "N",
                                                          .what = "Fy, of the part that yields",
                                                          .low = 1e-9,
                                                          .high = kUnbounded,
                                                          .neutral = kUnbounded},
                                          EffectParameter{.name = "stiffness_n_per_m",
                                                          .unit = "N/m",
                                                          .what = "k, of the part that yields",
                                                          .low = 1e-9,
                                                          .high = kUnbounded,
                                                          .neutral = kNoNeutral},
                                          EffectParameter{.name = "r0",
                                                          .unit = "",
                                                          .what = "R0, the larger the sharper the corner",
                                                          .low = 1.0,
                                                          .high = 100.0,
                                                          .neutral = kNoNeutral,
                                                          .fallback = 20.0}};

  Yielding(std::span<const double> values, double /*sample_period_s*/)
      : stiffness_n_per_m_{values[1]},
        spring_{{.stiffness_n_per_m = values[1], .yield_force_n = values[0], .hardening_ratio = 0.0, .r0 = values[2]}} {
  }
  void after(const StageSample& /*sample*/, const Motion& motion, double& force_n) noexcept override {
    force_n +=
        spring_.trial(motion.displacement_m, motion.velocity_m_per_s) - stiffness_n_per_m_ * motion.displacement_m;
    spring_.commit();
  }
  void reset() noexcept override { spring_.reset(); }

 private:
  double stiffness_n_per_m_;
  GiuffreMenegottoPinto spring_;
};

}  // namespace hybridtest
