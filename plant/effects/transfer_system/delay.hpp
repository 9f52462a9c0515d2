#pragma once

#include <algorithm>
#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/transfer_systems/delay_line.hpp"

namespace hybridtest {

/// The actuator is later than its model by tau (Horiuchi et al., Earthquake Eng. Struct. Dyn. 28,
/// 1999). A negative tau takes it off the model's own delay, which the transfer system is made
/// with (SiteModel); there is nothing left of it for this effect to do.
class TransferDelay final : public Effect {
 public:
  static constexpr std::string_view kEquation = "x(t) = x0(t - tau)";
  static constexpr std::string_view kSource = "Horiuchi et al. (1999)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::rate, .number = ModelNumber::delay, .needs_time = true};
  static constexpr std::array kParameters{EffectParameter{
      .name = "delay_s", .unit = "s", .what = "tau, real less model delay", .low = -10.0, .high = 10.0}};

  TransferDelay(std::span<const double> values, double sample_period_s)
      : line_{std::max(0.0, values[0]), sample_period_s} {}
  void before(const StageSample& /*sample*/, Motion& command) noexcept override {
    line_.push(command.displacement_m);
    command.displacement_m = line_.delayed_smoothly();
  }
  void reset() noexcept override { line_.reset(); }

 private:
  DelayLine line_;
};

}  // namespace hybridtest
