#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// An axial load on a leaning column of height h pushes it further (Chopra, Dynamics of Structures, 2012,
/// section 9.7; the exact lever arm of a rigid column): negative where the load pulls.
class GeometricStiffness final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 - P x / sqrt(h^2 - x^2)";
  static constexpr std::string_view kSource = "Chopra (2012), section 9.7";
  static constexpr EffectTraits kTraits{.family = EffectFamily::scale, .bends_curve = true};
  static constexpr std::array kParameters{EffectParameter{.name = "axial_force_n",
                                                          .unit = "N",
                                                          .what = "P, compression",
                                                          .low = -kUnbounded,
                                                          .high = kUnbounded,
                                                          .is_linear = true},
                                          EffectParameter{.name = "height_m",
                                                          .unit = "m",
                                                          .what = "h, of the column",
                                                          .low = 1e-9,
                                                          .high = kUnbounded,
                                                          .neutral = kNoNeutral}};

  GeometricStiffness(std::span<const double> values, double /*sample_period_s*/)
      : axial_force_n_{values[0]}, height_m_{values[1]} {}
  void after(const StageSample& sample, const Motion& /*motion*/, double& force_n) noexcept override {
    const double lean = std::clamp(sample.motion.displacement_m / height_m_, -kLeanMax, kLeanMax);
    force_n -= axial_force_n_ * lean / std::sqrt(1.0 - lean * lean);
  }
  void reset() noexcept override {}

 private:
  static constexpr double kLeanMax = 0.99;  // beyond, the column lies on the ground

  double axial_force_n_;
  double height_m_;
};

}  // namespace hybridtest
