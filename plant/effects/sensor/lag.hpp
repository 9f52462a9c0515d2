#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/second_order_lag.hpp"

namespace hybridtest {

/// A transducer or its filter that follows late: one pole, or two as most filters of load cells have (Figliola and
/// Beasley, Theory and Design for Mechanical Measurements, 2011, section 3.3); see SecondOrderLag.
class SensorLag final : public Effect {
 public:
  static constexpr std::string_view kEquation = "r + T r' + q T^2 r'' = y";
  static constexpr std::string_view kSource = "Figliola and Beasley (2011), section 3.3";
  static constexpr EffectTraits kTraits{.family = EffectFamily::rate, .needs_time = true};
  static constexpr std::array kParameters{
      EffectParameter{
          .name = "time_constant_s", .unit = "s", .what = "T, delay of a slow signal", .low = 0.0, .high = 1e3},
      second_order_ratio("q, 0: one pole, 0.25: two equal ones, 0.5: Butterworth")};

  SensorLag(std::span<const double> values, double sample_period_s) : lag_{values[0], values[1], sample_period_s} {}
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& output) noexcept override {
    output = lag_.step(output);
  }
  void reset() noexcept override { lag_.reset(); }

 private:
  SecondOrderLag lag_;
};

/// y = r + T r' + q T^2 r'', and its derivatives; those of the acceleration are backward differences.
class InverseSensorLag final : public Effect {
 public:
  InverseSensorLag(std::span<const double> values, double sample_period_s)
      : time_constant_s_{values[0]}, second_order_s2_{values[1] * values[0] * values[0]}, period_s_{sample_period_s} {}
  void before(const StageSample& /*sample*/, Motion& motion) noexcept override {
    const double read = motion.acceleration_m_per_s2;
    if (samples_ < 2) {
      ++samples_;
      if (samples_ == 1) before_ = read;
      long_before_ = before_;
    }
    const double rate = (1.5 * read - 2.0 * before_ + 0.5 * long_before_) / period_s_;
    const double change_of_rate = (read - 2.0 * before_ + long_before_) / (period_s_ * period_s_);
    motion.displacement_m += time_constant_s_ * motion.velocity_m_per_s + second_order_s2_ * read;
    motion.velocity_m_per_s += time_constant_s_ * read + second_order_s2_ * rate;
    motion.acceleration_m_per_s2 += time_constant_s_ * rate + second_order_s2_ * change_of_rate;
    long_before_ = before_;
    before_ = read;
  }
  void reset() noexcept override { samples_ = 0; }

 private:
  double time_constant_s_;
  double second_order_s2_;
  double period_s_;
  int samples_ = 0;  // read so far, up to 2
  double before_ = 0.0;
  double long_before_ = 0.0;
};

}  // namespace hybridtest
