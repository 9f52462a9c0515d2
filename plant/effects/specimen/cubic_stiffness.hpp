#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Stiffening with the cube of the displacement, softening where k3 is negative (Duffing, Erzwungene
/// Schwingungen, 1918).
class CubicStiffness final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + k3 x^3";
  static constexpr std::string_view kSource = "Duffing (1918)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::amplitude, .bends_curve = true};
  static constexpr std::array kParameters{EffectParameter{
      .name = "stiffness_n_per_m3", .unit = "N/m3", .what = "k3", .low = -1e18, .high = 1e18, .is_linear = true}};

  CubicStiffness(std::span<const double> values, double /*sample_period_s*/) : stiffness_n_per_m3_{values[0]} {}
  void after(const StageSample& /*sample*/, const Motion& motion, double& force_n) noexcept override {
    force_n += stiffness_n_per_m3_ * motion.displacement_m * motion.displacement_m * motion.displacement_m;
  }
  void reset() noexcept override {}

 private:
  double stiffness_n_per_m3_;
};

}  // namespace hybridtest
