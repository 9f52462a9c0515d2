#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// A transducer that is off by the same amount always: reading = true + b (Figliola and Beasley,
/// Theory and Design for Mechanical Measurements, 2011, section 1.4: zero-shift).
class SensorBias : public Effect {
 public:
  static constexpr std::string_view kEquation = "r = y + b";
  static constexpr std::string_view kSource = "Figliola and Beasley (2011), section 1.4";
  static constexpr EffectTraits kTraits{.family = EffectFamily::offset, .number = ModelNumber::offset};

  SensorBias(std::span<const double> values, double /*sample_period_s*/) : bias_{values[0]} {}
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& output) noexcept override {
    output += bias_;
  }
  void reset() noexcept override {}

 private:
  double bias_;
};

class DisplacementBias final : public SensorBias {
 public:
  using SensorBias::SensorBias;
  static constexpr std::array kParameters{EffectParameter{.name = "bias_m",
                                                          .unit = "m",
                                                          .what = "b, reading at zero displacement",
                                                          .low = -kUnbounded,
                                                          .high = kUnbounded,
                                                          .is_linear = true}};
};

class InverseDisplacementBias final : public Effect {
 public:
  InverseDisplacementBias(std::span<const double> values, double /*sample_period_s*/) : bias_m_{values[0]} {}
  void before(const StageSample& /*sample*/, Motion& motion) noexcept override { motion.displacement_m -= bias_m_; }
  void reset() noexcept override {}

 private:
  double bias_m_;
};

class ForceBias final : public SensorBias {
 public:
  using SensorBias::SensorBias;
  static constexpr std::array kParameters{EffectParameter{.name = "bias_n",
                                                          .unit = "N",
                                                          .what = "b, reading at zero force",
                                                          .low = -kUnbounded,
                                                          .high = kUnbounded,
                                                          .is_linear = true}};
};

}  // namespace hybridtest
