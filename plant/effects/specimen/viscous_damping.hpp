#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// A dashpot beside the model's law (Chopra, Dynamics of Structures, 2012, section 1.4); negative
/// where the model has too much damping.
class ViscousDamping final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + c v";
  static constexpr std::string_view kSource = "Chopra (2012), section 1.4";
  static constexpr EffectTraits kTraits{
      .family = EffectFamily::rate, .number = ModelNumber::damping, .follows_derivatives = true, .needs_time = true};
  static constexpr std::array kParameters{EffectParameter{.name = "damping_n_s_per_m",
                                                          .unit = "N s/m",
                                                          .what = "c, real less model damping",
                                                          .low = -kUnbounded,
                                                          .high = kUnbounded,
                                                          .is_linear = true}};

  ViscousDamping(std::span<const double> values, double /*sample_period_s*/) : damping_n_s_per_m_{values[0]} {}
  void after(const StageSample& sample, const Motion& /*motion*/, double& force_n) noexcept override {
    force_n += damping_n_s_per_m_ * sample.motion.velocity_m_per_s;
  }
  void reset() noexcept override {}

 private:
  double damping_n_s_per_m_;
};

}  // namespace hybridtest
