#pragma once

#include <algorithm>
#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// The piston meets the end of its cylinder (Merritt, Hydraulic Control Systems, 1967).
class StrokeLimit final : public Effect {
 public:
  static constexpr std::string_view kEquation = "x = clamp(x0, -s, s)";
  static constexpr std::string_view kSource = "Merritt (1967)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::position};
  static constexpr std::array kParameters{EffectParameter{.name = "stroke_limit_m",
                                                          .unit = "m",
                                                          .what = "s, to either side",
                                                          .low = 1e-9,
                                                          .high = kUnbounded,
                                                          .neutral = kUnbounded}};

  StrokeLimit(std::span<const double> values, double /*sample_period_s*/) : stroke_limit_m_{values[0]} {}
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& displacement_m) noexcept override {
    displacement_m = std::clamp(displacement_m, -stroke_limit_m_, stroke_limit_m_);
  }
  void reset() noexcept override {}

 private:
  double stroke_limit_m_;
};

}  // namespace hybridtest
