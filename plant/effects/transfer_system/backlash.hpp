#pragma once

#include <algorithm>
#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Play in the linkage of the actuator (Tao and Kokotovic, Adaptive Control of Systems with Actuator and Sensor
/// Nonlinearities, 1996, chapter 2): after each reversal it stands still over the clearance.
class TransferBacklash final : public Effect {
 public:
  static constexpr std::string_view kEquation = "y = clamp(y, x0 - c/2, x0 + c/2)";
  static constexpr std::string_view kSource = "Tao and Kokotovic (1996), chapter 2";
  static constexpr EffectTraits kTraits{.family = EffectFamily::amplitude};
  static constexpr std::array kParameters{EffectParameter{
      .name = "clearance_m", .unit = "m", .what = "c, from one side to the other", .low = 0.0, .high = kUnbounded}};

  TransferBacklash(std::span<const double> values, double /*sample_period_s*/) : half_clearance_m_{0.5 * values[0]} {}
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& displacement_m) noexcept override {
    position_m_ = std::clamp(position_m_, displacement_m - half_clearance_m_, displacement_m + half_clearance_m_);
    displacement_m = position_m_;
  }
  void reset() noexcept override { position_m_ = 0.0; }

 private:
  double half_clearance_m_;
  double position_m_ = 0.0;
};

}  // namespace hybridtest
