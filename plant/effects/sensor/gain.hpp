#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"

namespace hybridtest {

/// A transducer whose scale factor is wrong: reading = (1 + e) true (Figliola and Beasley, Theory and
/// Design for Mechanical Measurements, 2011, section 1.4: sensitivity error).
class SensorGain final : public Effect {
 public:
  static constexpr std::string_view kEquation = "r = (1 + e) y";
  static constexpr std::string_view kSource = "Figliola and Beasley (2011), section 1.4";
  static constexpr EffectTraits kTraits{.family = EffectFamily::scale};
  static constexpr std::array kParameters{EffectParameter{.name = "gain_error",
                                                          .unit = "",
                                                          .what = "e, share by which readings are too large",
                                                          .low = -2.0,
                                                          .high = 10.0,
                                                          .is_linear = true}};

  SensorGain(std::span<const double> values, double /*sample_period_s*/) : factor_{1.0 + values[0]} {}
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& output) noexcept override {
    output *= factor_;
  }
  void reset() noexcept override {}

 private:
  double factor_;
};

/// True motion of a read one. A sensor that reads nothing (e = -1) tells nothing: left as read.
class InverseSensorGain final : public Effect {
 public:
  InverseSensorGain(std::span<const double> values, double /*sample_period_s*/)
      : factor_{values[0] == -1.0 ? 1.0 : 1.0 / (1.0 + values[0])} {}
  void before(const StageSample& /*sample*/, Motion& motion) noexcept override {
    motion.displacement_m *= factor_;
    motion.velocity_m_per_s *= factor_;
    motion.acceleration_m_per_s2 *= factor_;
  }
  void reset() noexcept override {}

 private:
  double factor_;
};

}  // namespace hybridtest
