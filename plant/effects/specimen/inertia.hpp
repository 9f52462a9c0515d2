#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Mass that moves with the specimen between actuator and load cell (Newton); negative where the
/// model has too much of it.
class Inertia final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + m a";
  static constexpr std::string_view kSource = "Newton's second law";
  static constexpr EffectTraits kTraits{.family = EffectFamily::mass, .follows_derivatives = true, .needs_time = true};
  static constexpr std::array kParameters{EffectParameter{.name = "mass_kg",
                                                          .unit = "kg",
                                                          .what = "m, real less model mass",
                                                          .low = -kUnbounded,
                                                          .high = kUnbounded,
                                                          .is_linear = true}};

  Inertia(std::span<const double> values, double /*sample_period_s*/) : mass_kg_{values[0]} {}
  void after(const StageSample& sample, const Motion& /*motion*/, double& force_n) noexcept override {
    force_n += mass_kg_ * sample.motion.acceleration_m_per_s2;
  }
  void reset() noexcept override {}

 private:
  double mass_kg_;
};

}  // namespace hybridtest
