#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "experimental_site/effects/effect_type.hpp"
#include "experimental_site/effects/parameter_limits.hpp"
#include "experimental_site/effects/specimen/hysteretic_path.hpp"

namespace hybridtest {

/// A hysteretic element beside the model's law that slips where its force changes sign, as cracked concrete and
/// loose bolts do (Baber and Noori, J. Vib. Acoust. 108, 1986): Bouc and Wen's with n = 1 and
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
      : yield_force_n_{values[0]}, yield_displacement_m_{values[1]}, ratio_{values[2]}, width_{values[3]} {}
  void after(const StageSample& /*sample*/, const Motion& motion, double& force_n) noexcept override {
    const double way = (motion.displacement_m - displacement_m_) / yield_displacement_m_;
    displacement_m_ = motion.displacement_m;
    z_ = carried_along(z_, way, kSubstep * std::clamp(2.0 * width_, 0.2, 1.0), [this](double z, double direction) {
      const double loading = z * direction > 0.0 ? std::abs(z) : 0.0;
      return (1.0 - ratio_ * std::exp(-(z / width_) * (z / width_))) * (1.0 - loading);
    });
    force_n += yield_force_n_ * z_;
  }
  void reset() noexcept override { z_ = displacement_m_ = 0.0; }

 private:
  static constexpr double kSubstep = 0.1;

  double yield_force_n_;
  double yield_displacement_m_;
  double ratio_;
  double width_;
  double z_ = 0.0;
  double displacement_m_ = 0.0;
};

}  // namespace hybridtest
