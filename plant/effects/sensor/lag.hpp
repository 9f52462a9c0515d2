#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/first_order_lag.hpp"

namespace hybridtest {

/// A transducer or its filter that follows late: one pole (Figliola and Beasley, Theory and Design for
/// Mechanical Measurements, 2011, section 3.3).
class SensorLag final : public Effect {
 public:
  static constexpr std::string_view kEquation = "T r' + r = y";
  static constexpr std::string_view kSource = "Figliola and Beasley (2011), section 3.3";
  static constexpr EffectTraits kTraits{.family = EffectFamily::rate, .needs_time = true};
  static constexpr std::array kParameters{
      EffectParameter{.name = "time_constant_s", .unit = "s", .what = "T", .low = 0.0, .high = 1e3}};

  SensorLag(std::span<const double> values, double sample_period_s) : lag_{values[0], sample_period_s} {}
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& output) noexcept override {
    output = lag_.step(output);
  }
  void reset() noexcept override { lag_.reset(); }

 private:
  FirstOrderLag lag_;
};

/// y = r + T r', and its derivatives; that of the acceleration is the second-order backward difference.
class InverseSensorLag final : public Effect {
 public:
  InverseSensorLag(std::span<const double> values, double sample_period_s)
      : time_constant_s_{values[0]}, sample_period_s_{sample_period_s} {}
  void before(const StageSample& /*sample*/, Motion& motion) noexcept override {
    const double read = motion.acceleration_m_per_s2;
    if (samples_ < 2) {
      ++samples_;
      if (samples_ == 1) before_ = read;
      long_before_ = before_;
    }
    motion.displacement_m += time_constant_s_ * motion.velocity_m_per_s;
    motion.velocity_m_per_s += time_constant_s_ * read;
    motion.acceleration_m_per_s2 +=
        time_constant_s_ * (1.5 * read - 2.0 * before_ + 0.5 * long_before_) / sample_period_s_;
    long_before_ = before_;
    before_ = read;
  }
  void reset() noexcept override { samples_ = 0; }

 private:
  double time_constant_s_;
  double sample_period_s_;
  int samples_ = 0;  // read so far, up to 2
  double before_ = 0.0;
  double long_before_ = 0.0;
};

}  // namespace hybridtest
