#pragma once

#include <array>

#include "experimental_site/effects/effect_type.hpp"
#include "experimental_site/effects/parameter_limits.hpp"
#include "mechanics/bouc_wen.hpp"

namespace hybridtest {

/// A smooth hysteretic element beside the model's law (Bouc, 1967; Wen, J. Eng. Mech. Div. ASCE 102, 1976;
/// mechanics): z in units of the yield displacement xy, beta + gamma = 1, s = beta / (beta + gamma).
class BoucWenHysteresis final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + Fy z, dz = (1 - (s sign(z dx) + 1 - s) |z|^n) dx / xy";
  static constexpr std::string_view kSource = "Wen (1976)";
  static constexpr std::array kParameters{EffectParameter{.name = "yield_force_n",
                                                          .unit = "N",
                                                          .what = "Fy",
                                                          .low = 0.0,
                                                          .high = kUnbounded,
                                                          .scale = ParameterScale::force_n,
                                                          .search_low = 0.0,
                                                          .search_high = 2.0,
                                                          .is_linear = true},
                                          EffectParameter{.name = "yield_displacement_m",
                                                          .unit = "m",
                                                          .what = "xy",
                                                          .low = 1e-9,
                                                          .high = kUnbounded,
                                                          .scale = ParameterScale::displacement_m,
                                                          .search_low = 0.005,
                                                          .search_high = 1.0,
                                                          .neutral = kNoNeutral},
                                          EffectParameter{.name = "exponent",
                                                          .unit = "",
                                                          .what = "n, the larger the sharper the corner",
                                                          .low = 1.0,
                                                          .high = 20.0,
                                                          .search_low = 1.0,
                                                          .search_high = 5.0,
                                                          .neutral = kNoNeutral,
                                                          .fallback = 1.0},
                                          EffectParameter{.name = "dissipation_share",
                                                          .unit = "",
                                                          .what = "s, 0.5: unloads along a straight line",
                                                          .low = 0.05,
                                                          .high = 1.0,
                                                          .search_low = 0.2,
                                                          .search_high = 1.0,
                                                          .neutral = kNoNeutral,
                                                          .fallback = 0.5}};

  BoucWenHysteresis(std::span<const double> values, double /*sample_period_s*/)
      : yield_force_n_{values[0]},
        element_{{.stiffness_n_per_m = 1.0,
                  .alpha = 0.0,
                  .n = values[2],
                  .gamma_per_m = 1.0 - values[3],
                  .beta_per_m = values[3],
                  .ao = 1.0}},
        yield_displacement_m_{values[1]} {}
  void after(const StageSample& /*sample*/, const Motion& motion, double& force_n) noexcept override {
    force_n += yield_force_n_ * element_.trial(motion.displacement_m / yield_displacement_m_, 0.0);
    element_.commit();
  }
  void reset() noexcept override { element_.reset(); }

 private:
  double yield_force_n_;
  BoucWen element_;  // in units of the yield displacement
  double yield_displacement_m_;
};

}  // namespace hybridtest
