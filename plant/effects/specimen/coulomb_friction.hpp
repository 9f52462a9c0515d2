#pragma once

#include <array>
#include <cmath>

#include "mechanics/laws/presliding_element.hpp"
#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"
#include "plant/effects/specimen/presliding_exponent.hpp"

namespace hybridtest {

/// Dry friction beside the model's law, with Dahl's way to sliding (PreslidingElement). With the
/// asymmetry a it slides at Fc (1 + a) towards positive displacements and at Fc (1 - a) back.
class CoulombFriction final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + Fc (z + a |z|), dz = (1 - z sign(dx))^i dx / d, |z| <= 1";
  static constexpr std::string_view kSource = "Coulomb (1785); Dahl (1968)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::amplitude, .takes_place = true};
  static constexpr std::array kParameters{EffectParameter{.name = "friction_force_n",
                                                          .unit = "N",
                                                          .what = "Fc, while sliding",
                                                          .low = 0.0,
                                                          .high = kUnbounded,
                                                          .is_linear = true},
                                          EffectParameter{.name = "asymmetry",
                                                          .unit = "",
                                                          .what = "a, more one way than back",
                                                          .low = -1.0,
                                                          .high = 1.0,
                                                          .neutral = kNoNeutral,
                                                          .fallback = 0.0},
                                          EffectParameter{.name = "presliding_displacement_m",
                                                          .unit = "m",
                                                          .what = "d, until it slides, at its first stiffness Fc / d",
                                                          .low = 1e-12,
                                                          .high = kUnbounded,
                                                          .neutral = kNoNeutral,
                                                          .fallback = 1e-5},
                                          kPreslidingExponent};

  CoulombFriction(std::span<const double> values, double /*sample_period_s*/)
      : friction_force_n_{values[0]}, asymmetry_{values[1]}, element_{values[2], values[3]} {}
  void after(const StageSample& /*sample*/, const Motion& motion, double& force_n) noexcept override {
    const double share = element_.share(motion.displacement_m);
    force_n += friction_force_n_ * (share + asymmetry_ * std::abs(share));
  }
  void reset() noexcept override { element_.reset(); }

 private:
  double friction_force_n_;
  double asymmetry_;
  PreslidingElement element_;
};

}  // namespace hybridtest
