#pragma once

#include <algorithm>
#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// The servo-valve has no more flow (Merritt, Hydraulic Control Systems, 1967, section 5.4: flow over piston
/// area): the actuator follows at its greatest velocity until it has caught up.
class VelocityLimit final : public Effect {
 public:
  static constexpr std::string_view kEquation = "|x'| <= vmax, else x = x0";
  static constexpr std::string_view kSource = "Merritt (1967)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::rate, .needs_time = true};
  static constexpr std::array kParameters{EffectParameter{.name = "velocity_limit_m_per_s",
                                                          .unit = "m/s",
                                                          .what = "vmax",
                                                          .low = 1e-9,
                                                          .high = kUnbounded,
                                                          .neutral = kUnbounded}};

  VelocityLimit(std::span<const double> values, double sample_period_s) : travel_m_max_{values[0] * sample_period_s} {}
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& displacement_m) noexcept override {
    position_m_ = std::clamp(displacement_m, position_m_ - travel_m_max_, position_m_ + travel_m_max_);
    displacement_m = position_m_;
  }
  void reset() noexcept override { position_m_ = 0.0; }

 private:
  double travel_m_max_;  // in one sample
  double position_m_ = 0.0;
};

}  // namespace hybridtest
