#pragma once

#include <array>
#include <cmath>

#include "mechanics/laws/presliding_element.hpp"
#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"
#include "plant/effects/specimen/presliding_exponent.hpp"

namespace hybridtest {

/// Dry friction that falls with the velocity from its static value (Stribeck, 1902; Armstrong-Helouvry,
/// Dupont and Canudas de Wit, Automatica 30, 1994), before it slides as coulomb_friction.
class StribeckFriction final : public Effect {
 public:
  static constexpr std::string_view kEquation =
      "F = F0 + Fc z, dz = (1 - z sign(dx) / L)^i dx / d, |z| <= L = 1 + r exp(-(v / vs)^2)";
  static constexpr std::string_view kSource = "Armstrong-Helouvry et al. (1994)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::rate, .needs_time = true, .takes_place = true};
  static constexpr std::array kParameters{
      EffectParameter{.name = "friction_force_n",
                      .unit = "N",
                      .what = "Fc, at high velocity",
                      .low = 0.0,
                      .high = kUnbounded,
                      .is_linear = true},
      EffectParameter{.name = "static_excess_ratio",
                      .unit = "",
                      .what = "r, static friction over Fc less 1",
                      .low = 0.0,
                      .high = 100.0,
                      .neutral = kNoNeutral},
      EffectParameter{.name = "stribeck_velocity_m_per_s",
                      .unit = "m/s",
                      .what = "vs",
                      .low = 1e-9,
                      .high = kUnbounded,
                      .neutral = kNoNeutral},
      EffectParameter{.name = "presliding_displacement_m",
                      .unit = "m",
                      .what = "d, until it slides with Fc, at its first stiffness Fc / d",
                      .low = 1e-12,
                      .high = kUnbounded,
                      .neutral = kNoNeutral,
                      .fallback = 1e-5},
      kPreslidingExponent};

  StribeckFriction(std::span<const double> values, double /*sample_period_s*/)
      : friction_force_n_{values[0]},
        static_excess_ratio_{values[1]},
        velocity_m_per_s_{values[2]},
        element_{values[3], values[4]} {}
  void after(const StageSample& sample, const Motion& motion, double& force_n) noexcept override {
    const double speed = sample.motion.velocity_m_per_s / velocity_m_per_s_;
    const double limit = 1.0 + static_excess_ratio_ * std::exp(-speed * speed);
    force_n += friction_force_n_ * element_.share(motion.displacement_m, limit);
  }
  void reset() noexcept override { element_.reset(); }

 private:
  double friction_force_n_;
  double static_excess_ratio_;
  double velocity_m_per_s_;
  PreslidingElement element_;
};

}  // namespace hybridtest
