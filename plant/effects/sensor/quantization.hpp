#pragma once

#include <array>
#include <cmath>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// A converter with coarse steps (Widrow and Kollar, Quantization Noise, 2008): readings are whole multiples of
/// the step, none when it is zero.
class SensorQuantization : public Effect {
 public:
  static constexpr std::string_view kEquation = "r = q round(y / q)";
  static constexpr std::string_view kSource = "Widrow and Kollar (2008)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::amplitude, .digits = DigitTrace::rounding};

  SensorQuantization(std::span<const double> values, double /*sample_period_s*/) : step_{values[0]} {}
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& output) noexcept override {
    if (step_ > 0.0) output = step_ * std::round(output / step_);
  }
  void reset() noexcept override {}

 private:
  double step_;
};

class DisplacementQuantization final : public SensorQuantization {
 public:
  using SensorQuantization::SensorQuantization;
  static constexpr std::array kParameters{
      EffectParameter{.name = "step_m", .unit = "m", .what = "q, of the readings", .low = 0.0, .high = kUnbounded}};
};

class ForceQuantization final : public SensorQuantization {
 public:
  using SensorQuantization::SensorQuantization;
  static constexpr std::array kParameters{
      EffectParameter{.name = "step_n", .unit = "N", .what = "q, of the readings", .low = 0.0, .high = kUnbounded}};
};

}  // namespace hybridtest
