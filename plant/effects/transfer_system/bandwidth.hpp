#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/second_order_lag.hpp"

namespace hybridtest {

/// The actuator has poles that its model lacks (Zhao, French, Shield and Posbergh, Earthquake Eng.
/// Struct. Dyn. 32, 2003); see SecondOrderLag.
class Bandwidth final : public Effect {
 public:
  static constexpr std::string_view kEquation = "x0 + T x0' + r T^2 x0'' = u";
  static constexpr std::string_view kSource = "Zhao et al. (2003)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::rate, .needs_time = true};
  static constexpr std::array kParameters{
      EffectParameter{
          .name = "time_constant_s", .unit = "s", .what = "T, delay of slow motion", .low = 0.0, .high = 1e3},
      second_order_ratio("r, 0: one pole, 0.25: two equal ones")};

  Bandwidth(std::span<const double> values, double sample_period_s) : lag_{values[0], values[1], sample_period_s} {}
  void before(const StageSample& /*sample*/, Motion& command) noexcept override {
    command.displacement_m = lag_.step(command.displacement_m);
  }
  void reset() noexcept override { lag_.reset(); }

 private:
  SecondOrderLag lag_;
};

}  // namespace hybridtest
