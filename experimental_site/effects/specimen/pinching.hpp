#pragma once

#include <array>

#include "experimental_site/effects/effect_type.hpp"
#include "experimental_site/effects/parameter_limits.hpp"
#include "mechanics/bouc_wen_baber_noori.hpp"

namespace hybridtest {

/// A hysteretic element beside the model's law that slips where its force changes sign, as cracked concrete and
/// loose bolts do (Baber and Noori, J. Vib. Acoust. 108, 1986; mechanics): Bouc and Wen's with n = 1 and
/// s = 1/2, softer around z = 0 by the pinching ratio.
class Pinching final : public Effect {
 public:
  static constexpr std::string_view kEquation =
      "F = F0 + Fy z, dz = (1 - p exp(-(z / w)^2)) (1 - (sign(z dx) + 1) |z| / 2) dx / xy";
  static constexpr std::string_view kSource = "Baber and Noori (1986)";
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
                                          EffectParameter{.name = "pinching_ratio",
                                                          .unit = "",
                                                          .what = "p, softer by at zero force",
                                                          .low = 0.0,
                                                          .high = 0.99,
                                                          .search_low = 0.3,
                                                          .search_high = 0.98,
                                                          .neutral = kNoNeutral},
                                          EffectParameter{.name = "pinching_width",
                                                          .unit = "",
                                                          .what = "w, of z in which it slips",
                                                          .low = 0.01,
                                                          .high = 10.0,
                                                          .search_low = 0.05,
                                                          .search_high = 1.0,
                                                          .neutral = kNoNeutral,
                                                          .fallback = 0.3}};

  Pinching(std::span<const double> values, double /*sample_period_s*/)
      : yield_force_n_{values[0]}, yield_displacement_m_{values[1]}, element_{element(values[2], values[3])} {}
  void after(const StageSample& /*sample*/, const Motion& motion, double& force_n) noexcept override {
    force_n += yield_force_n_ * element_.trial(motion.displacement_m / yield_displacement_m_, 0.0);
    element_.commit();
  }
  void reset() noexcept override { element_.reset(); }

 private:
  /// In units of yield force and yield displacement; it pinches from the beginning.
  static BoucWenBaberNoori element(double ratio, double width) {
    return BoucWenBaberNoori{{.stiffness_n_per_m = 1.0,
                              .alpha = 0.0,
                              .n = 1.0,
                              .gamma_per_m = 0.5,
                              .beta_per_m = 0.5,
                              .ao = 1.0,
                              .pinching = ratio,
                              .pinching_rate_per_j = 1e12,
                              .pinching_width_m = width / (1.0 + ratio),
                              .width_share = 1.0}};
  }

  double yield_force_n_;
  double yield_displacement_m_;
  BoucWenBaberNoori element_;
};

}  // namespace hybridtest
