#pragma once

#include <array>
#include <cmath>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Damping with the square of the velocity, as of an orifice or of water (Chopra, Dynamics of
/// Structures, 2012, section 3.9).
class QuadraticDamping final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + c v |v|";
  static constexpr std::string_view kSource = "Chopra (2012), section 3.9";
  static constexpr EffectTraits kTraits{.family = EffectFamily::rate, .follows_derivatives = true, .needs_time = true};
  static constexpr std::array kParameters{EffectParameter{.name = "damping_n_s2_per_m2",
                                                          .unit = "N s2/m2",
                                                          .what = "c",
                                                          .low = -kUnbounded,
                                                          .high = kUnbounded,
                                                          .is_linear = true}};

  QuadraticDamping(std::span<const double> values, double /*sample_period_s*/) : damping_n_s2_per_m2_{values[0]} {}
  void after(const StageSample& sample, const Motion& /*motion*/, double& force_n) noexcept override {
    const double velocity = sample.motion.velocity_m_per_s;
    force_n += damping_n_s2_per_m2_ * velocity * std::abs(velocity);
  }
  void reset() noexcept override {}

 private:
  double damping_n_s2_per_m2_;
};

}  // namespace hybridtest
