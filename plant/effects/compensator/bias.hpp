#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// A constant is added to the command, as of an offset between compensator and controller.
class CompensatorBias final : public Effect {
 public:
  static constexpr std::string_view kEquation = "u = u0 + b";
  static constexpr std::string_view kSource = "an offset in the chain of commands";
  static constexpr EffectTraits kTraits{.family = EffectFamily::offset};
  static constexpr std::array kParameters{EffectParameter{
      .name = "bias_m", .unit = "m", .what = "b", .low = -kUnbounded, .high = kUnbounded, .is_linear = true}};

  CompensatorBias(std::span<const double> values, double /*sample_period_s*/) : bias_m_{values[0]} {}
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& command_m) noexcept override {
    command_m += bias_m_;
  }
  void reset() noexcept override {}

 private:
  double bias_m_;
};

}  // namespace hybridtest
