#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "experimental_site/effects/effect_type.hpp"
#include "experimental_site/effects/parameter_limits.hpp"

namespace hybridtest {

/// Dry friction beside the model's law, elastoplastic before it slides (Dahl, The Aerospace
/// Corporation TOR-0158, 1968, with the exponent 0): the force goes with the displacement since the
/// last reversal until that reaches the pre-sliding displacement, so that a specimen at rest holds
/// and no sign of a noisy velocity is needed. With the asymmetry a it slides at Fc (1 + a) towards
/// positive displacements and at Fc (1 - a) back.
class CoulombFriction final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + Fc (z + a |z|), dz = dx / d, |z| <= 1";
  static constexpr std::string_view kSource = "Coulomb (1785); Dahl (1968)";
  static constexpr std::array kParameters{EffectParameter{.name = "friction_force_n",
                                                          .unit = "N",
                                                          .what = "Fc, while sliding",
                                                          .low = 0.0,
                                                          .high = kUnbounded,
                                                          .scale = ParameterScale::force_n,
                                                          .search_low = 0.0,
                                                          .search_high = 1.5,
                                                          .is_linear = true},
                                          EffectParameter{.name = "asymmetry",
                                                          .unit = "",
                                                          .what = "a, more one way than back",
                                                          .low = -1.0,
                                                          .high = 1.0,
                                                          .search_low = -0.9,
                                                          .search_high = 0.9,
                                                          .neutral = kNoNeutral,
                                                          .fallback = 0.0},
                                          EffectParameter{.name = "presliding_displacement_m",
                                                          .unit = "m",
                                                          .what = "d, until it slides",
                                                          .low = 1e-12,
                                                          .high = kUnbounded,
                                                          .scale = ParameterScale::displacement_m,
                                                          .search_low = 1e-4,
                                                          .search_high = 0.1,
                                                          .neutral = kNoNeutral,
                                                          .fallback = 1e-5}};

  CoulombFriction(std::span<const double> values, double /*sample_period_s*/)
      : friction_force_n_{values[0]}, asymmetry_{values[1]}, presliding_displacement_m_{values[2]} {}
  void after(const StageSample& sample, const Motion& /*motion*/, double& force_n) noexcept override {
    const double travel_m = sample.motion.displacement_m - displacement_m_;
    displacement_m_ = sample.motion.displacement_m;
    share_ = std::clamp(share_ + travel_m / presliding_displacement_m_, -1.0, 1.0);
    force_n += friction_force_n_ * (share_ + asymmetry_ * std::abs(share_));
  }
  void reset() noexcept override { share_ = displacement_m_ = 0.0; }

 private:
  double friction_force_n_;
  double asymmetry_;
  double presliding_displacement_m_;
  double share_ = 0.0;  // of the friction force, with the sign of the motion
  double displacement_m_ = 0.0;
};

}  // namespace hybridtest
