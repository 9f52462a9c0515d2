#pragma once

#include <algorithm>
#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Commands near zero do not reach the actuator (Tao and Kokotovic, Adaptive Control of Systems with Actuator
/// and Sensor Nonlinearities, 1996, chapter 2: dead zone).
class Deadband final : public Effect {
 public:
  static constexpr std::string_view kEquation = "x = x0(u - clamp(u, -d, d))";
  static constexpr std::string_view kSource = "Tao and Kokotovic (1996), chapter 2";
  static constexpr EffectTraits kTraits{.family = EffectFamily::position};
  static constexpr std::array kParameters{EffectParameter{
      .name = "deadband_m", .unit = "m", .what = "d, on either side of zero", .low = 0.0, .high = kUnbounded}};

  Deadband(std::span<const double> values, double /*sample_period_s*/) : deadband_m_{values[0]} {}
  void before(const StageSample& /*sample*/, Motion& command) noexcept override {
    command.displacement_m -= std::clamp(command.displacement_m, -deadband_m_, deadband_m_);
  }
  void reset() noexcept override {}

 private:
  double deadband_m_;
};

}  // namespace hybridtest
