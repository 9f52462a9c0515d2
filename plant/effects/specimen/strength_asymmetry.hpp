#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// The specimen is stronger to one side than to the other, with the same stiffness before and after yielding: a
/// buckling-restrained brace, whose compression strength is beta times its tension strength (ANSI/AISC 341-16, section
/// F4.2a), or a beam with more bars at the top. The law, moved by d within its elastic range and without force at rest
/// at zero, yields at Fy + k d and at -(Fy - k d). A spring stays as it is.
///
/// The force at zero, F0(-d), is what the law gives at the first sample, for the share of its motion.
class StrengthAsymmetry final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0(x - d) - F0(-d)";
  static constexpr std::string_view kSource = "ANSI/AISC 341-16, section F4.2a";
  static constexpr EffectTraits kTraits{.family = EffectFamily::amplitude, .bends_curve = true};
  static constexpr std::array kParameters{EffectParameter{
      .name = "shift_m",
      .unit = "m",
      .what = "d, of the elastic range; positive and negative strength differ by twice the stiffness times d",
      .low = -kUnbounded,
      .high = kUnbounded}};

  StrengthAsymmetry(std::span<const double> values, double /*sample_period_s*/) : shift_m_{values[0]} {}
  void before(const StageSample& /*sample*/, Motion& motion) noexcept override { motion.displacement_m -= shift_m_; }
  void after(const StageSample& /*sample*/, const Motion& motion, double& force_n) noexcept override {
    if (!is_at_rest_known_) {
      is_at_rest_known_ = true;
      if (motion.displacement_m != 0.0) at_rest_n_ = -shift_m_ * force_n / motion.displacement_m;
    }
    force_n -= at_rest_n_;
  }
  void reset() noexcept override {
    is_at_rest_known_ = false;
    at_rest_n_ = 0.0;
  }

 private:
  double shift_m_;
  bool is_at_rest_known_ = false;
  double at_rest_n_ = 0.0;
};

}  // namespace hybridtest
