#pragma once

#include <array>

#include "mechanics/laws/gap_spring.hpp"
#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Clearance at a fixed position between actuator and specimen: within the gap on either side of zero the
/// specimen feels nothing, beyond it the motion less the gap (Chopra, Dynamics of Structures, 2012, section 22.1).
class Gap final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0(x - clamp(x, -g, g))";
  static constexpr std::string_view kSource = "Chopra (2012), section 22.1";
  static constexpr EffectTraits kTraits{.family = EffectFamily::position, .bends_curve = true};
  static constexpr std::array kParameters{
      EffectParameter{.name = "gap_m", .unit = "m", .what = "g, on either side", .low = 0.0, .high = kUnbounded}};

  Gap(std::span<const double> values, double /*sample_period_s*/) : gap_m_{values[0]} {}
  void before(const StageSample& /*sample*/, Motion& motion) noexcept override {
    motion.displacement_m = beyond_gap_m(motion.displacement_m, gap_m_);
    if (motion.displacement_m == 0.0) motion.velocity_m_per_s = motion.acceleration_m_per_s2 = 0.0;
  }
  void reset() noexcept override {}

 private:
  double gap_m_;
};

}  // namespace hybridtest
