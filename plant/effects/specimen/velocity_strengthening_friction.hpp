#pragma once

#include <array>
#include <cmath>

#include "mechanics/laws/presliding_element.hpp"
#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Dry friction that grows with the velocity, as that of PTFE on steel (Constantinou, Mokha and Reinhorn, J. Struct.
/// Eng. 116, 1990), before it slides as coulomb_friction. With a slow share of zero it is a dashpot whose force ends at
/// the friction: two surfaces with a film between them, or dry friction behind a dashpot in series.
class VelocityStrengtheningFriction final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + Fc z, dz = dx / d, |z| <= 1 - (1 - s) exp(-a |v|)";
  static constexpr std::string_view kSource = "Constantinou, Mokha and Reinhorn (1990)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::rate, .needs_time = true, .takes_place = true};
  static constexpr std::array kParameters{
      EffectParameter{.name = "friction_force_n",
                      .unit = "N",
                      .what = "Fc, at high velocity",
                      .low = 0.0,
                      .high = kUnbounded,
                      .is_linear = true},
      EffectParameter{.name = "slow_friction_ratio",
                      .unit = "",
                      .what = "s, friction at low velocity over Fc",
                      .low = 0.0,
                      .high = 1.0,
                      .neutral = kNoNeutral},
      EffectParameter{.name = "friction_rate_s_per_m",
                      .unit = "s/m",
                      .what = "a, the larger, the sooner it is that of high velocity",
                      .low = 0.0,
                      .high = kUnbounded,
                      .neutral = kNoNeutral},
      EffectParameter{.name = "presliding_displacement_m",
                      .unit = "m",
                      .what = "d, until it slides with Fc, at its first stiffness Fc / d",
                      .low = 1e-12,
                      .high = kUnbounded,
                      .neutral = kNoNeutral,
                      .fallback = 1e-5}};

  VelocityStrengtheningFriction(std::span<const double> values, double /*sample_period_s*/)
      : friction_force_n_{values[0]}, slow_ratio_{values[1]}, rate_s_per_m_{values[2]}, element_{values[3]} {}
  void after(const StageSample& sample, const Motion& motion, double& force_n) noexcept override {
    const double missing = (1.0 - slow_ratio_) * std::exp(-rate_s_per_m_ * std::abs(sample.motion.velocity_m_per_s));
    force_n += friction_force_n_ * element_.share(motion.displacement_m, 1.0 - missing);
  }
  void reset() noexcept override { element_.reset(); }

 private:
  double friction_force_n_;
  double slow_ratio_;
  double rate_s_per_m_;
  PreslidingElement element_;
};

}  // namespace hybridtest
