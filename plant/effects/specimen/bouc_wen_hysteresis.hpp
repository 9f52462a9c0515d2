#pragma once

#include <array>
#include <cmath>

#include "mechanics/laws/power.hpp"
#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"
#include "plant/effects/specimen/hysteretic_path.hpp"

namespace hybridtest {

/// A smooth hysteretic element beside the law of the model (Bouc, 1967; Wen, J. Eng. Mech. Div. ASCE 102,
/// 1976): z in units of the yield displacement xy, beta + gamma = 1, s = beta / (beta + gamma).
class BoucWenHysteresis final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + Fy z, dz = (1 - (s sign(z dx) + 1 - s) |z|^n) dx / xy";
  static constexpr std::string_view kSource = "Wen (1976)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::amplitude, .takes_place = true};
  static constexpr std::array kParameters{
      EffectParameter{
          .name = "yield_force_n", .unit = "N", .what = "Fy", .low = 0.0, .high = kUnbounded, .is_linear = true},
      EffectParameter{.name = "yield_displacement_m",
                      .unit = "m",
                      .what = "xy",
                      .low = 1e-9,
                      .high = kUnbounded,
                      // What yields before, slides: dry friction.
                      .neutral = kNoNeutral},
      EffectParameter{.name = "exponent",
                      .unit = "",
                      .what = "n, the larger the sharper the corner",
                      .low = 1.0,
                      .high = 20.0,
                      .neutral = kNoNeutral,
                      .fallback = 1.0},
      EffectParameter{.name = "dissipation_share",
                      .unit = "",
                      .what = "s, 0.5: unloads along a straight line",
                      .low = 0.05,
                      .high = 1.0,
                      .neutral = kNoNeutral,
                      .fallback = 0.5}};

  BoucWenHysteresis(std::span<const double> values, double /*sample_period_s*/)
      : yield_force_n_{values[0]},
        yield_displacement_m_{values[1]},
        exponent_{values[2]},
        unloading_{1.0 - 2.0 * values[3]} {}
  void after(const StageSample& /*sample*/, const Motion& motion, double& force_n) noexcept override {
    const double way = (motion.displacement_m - displacement_m_) / yield_displacement_m_;
    displacement_m_ = motion.displacement_m;
    z_ = exponent_ == 1.0 ? exponential(way) : carried_along(z_, way, kSubstep, [this](double z, double direction) {
      return 1.0 - (z * direction < 0.0 ? unloading_ : 1.0) * power_of(std::abs(z), exponent_);
    });
    force_n += yield_force_n_ * z_;
  }
  void reset() noexcept override { z_ = displacement_m_ = 0.0; }

 private:
  static constexpr double kSubstep = 0.1;
  /// Below this the unloading branch is as good as straight.
  static constexpr double kStraight = 1e-9;

  /// z after the way, exact for n = 1; w is z counted positive in the direction of motion.
  [[nodiscard]] double exponential(double way) const noexcept {
    double left = std::abs(way);
    double w = way < 0.0 ? -z_ : z_;
    if (w < 0.0) {
      const bool straight = std::abs(unloading_) < kStraight;
      const double to_zero = straight ? -w : -std::log1p(unloading_ * w) / unloading_;
      if (left < to_zero) {
        w = straight ? w + left : w * std::exp(unloading_ * left) + std::expm1(unloading_ * left) / unloading_;
        return way < 0.0 ? -w : w;
      }
      left -= to_zero;
      w = 0.0;
    }
    w = 1.0 - (1.0 - w) * std::exp(-left);
    return way < 0.0 ? -w : w;
  }

  double yield_force_n_;
  double yield_displacement_m_;
  double exponent_;
  double unloading_;  // gamma - beta
  double z_ = 0.0;
  double displacement_m_ = 0.0;
};

}  // namespace hybridtest
