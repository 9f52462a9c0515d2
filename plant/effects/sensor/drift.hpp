#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// A transducer whose zero wanders at a steady rate (Figliola and Beasley, Theory and Design for
/// Mechanical Measurements, 2011, section 1.4: thermal drift).
class SensorDrift : public Effect {
 public:
  static constexpr std::string_view kEquation = "r = y + d t";
  static constexpr std::string_view kSource = "Figliola and Beasley (2011), section 1.4";
  static constexpr EffectTraits kTraits{.family = EffectFamily::offset, .needs_time = true};

  SensorDrift(std::span<const double> values, double /*sample_period_s*/) : drift_per_s_{values[0]} {}
  void after(const StageSample& sample, const Motion& /*motion*/, double& output) noexcept override {
    output += drift_per_s_ * sample.time_s;
  }
  void reset() noexcept override {}

 private:
  double drift_per_s_;
};

class DisplacementDrift final : public SensorDrift {
 public:
  using SensorDrift::SensorDrift;
  static constexpr std::array kParameters{EffectParameter{
      .name = "drift_m_per_s", .unit = "m/s", .what = "d", .low = -kUnbounded, .high = kUnbounded, .is_linear = true}};
};

class InverseDisplacementDrift final : public Effect {
 public:
  InverseDisplacementDrift(std::span<const double> values, double /*sample_period_s*/) : drift_m_per_s_{values[0]} {}
  void before(const StageSample& sample, Motion& motion) noexcept override {
    motion.displacement_m -= drift_m_per_s_ * sample.time_s;
    motion.velocity_m_per_s -= drift_m_per_s_;
  }
  void reset() noexcept override {}

 private:
  double drift_m_per_s_;
};

class ForceDrift final : public SensorDrift {
 public:
  using SensorDrift::SensorDrift;
  static constexpr std::array kParameters{EffectParameter{
      .name = "drift_n_per_s", .unit = "N/s", .what = "d", .low = -kUnbounded, .high = kUnbounded, .is_linear = true}};
};

}  // namespace hybridtest
