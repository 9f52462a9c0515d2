#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// The specimen yields at another force than its model says: the law, scaled by s in force and displacement alike, has
/// s times the strength, the same stiffness before yielding and the same stiffness after it.
class StrengthError final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = s F0(x / s), s = 1 + e";
  static constexpr std::string_view kSource = "similarity of the law; a wrong number of the user's model";
  static constexpr EffectTraits kTraits{.family = EffectFamily::amplitude, .number = ModelNumber::strength};
  static constexpr std::array kParameters{EffectParameter{.name = "strength_error_ratio",
                                                          .unit = "",
                                                          .what = "e, real over the law's strength less 1",
                                                          .low = -0.99,
                                                          .high = kUnbounded,
                                                          .neutral = 0.0}};

  StrengthError(std::span<const double> values, double /*sample_period_s*/) : scale_{1.0 + values[0]} {}
  [[nodiscard]] bool is_of_base() const noexcept override { return true; }
  void before_base(Motion& motion) noexcept override {
    motion.displacement_m /= scale_;
    motion.velocity_m_per_s /= scale_;
  }
  void after_base(double& force_n) noexcept override { force_n *= scale_; }
  void reset() noexcept override {}

 private:
  double scale_;
};

}  // namespace hybridtest
