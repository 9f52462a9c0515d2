#pragma once

#include <array>
#include <cmath>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"
#include "plant/effects/specimen/degradation_drivers.hpp"

namespace hybridtest {

/// The specimen gets softer with what it went through (Baber and Wen, J. Eng. Mech. Div. ASCE 107, 1981, whose eta
/// grows with the dissipated energy; Park and Ang, J. Struct. Eng. 111, 1985; Krawinkler and Zohrei, Computers &
/// Structures 16, 1983; Makris, J. Eng. Mech. 124, 1998): half of its stiffness is left once the driver has come to L.
/// A law that yields keeps its strength, or loses it with the power q of the stiffness that is left.
template <class Driver>
class StiffnessDegradation final : public Effect {
 public:
  static constexpr std::string_view kEquation = Driver::kStiffness.equation;
  static constexpr std::string_view kSource = Driver::kSource;
  static constexpr EffectTraits kTraits{.family = EffectFamily::degradation, .needs_time = Driver::kNeedsTime};
  static constexpr std::array kParameters{
      EffectParameter{.name = Driver::kStiffness.parameter,
                      .unit = Driver::kUnit,
                      .what = Driver::kStiffness.what,
                      .low = 1e-9,
                      .high = kUnbounded,
                      .neutral = kUnbounded},
      EffectParameter{.name = "strength_exponent",
                      .unit = "",
                      .what = "q, 0: it keeps its strength, 1: it loses as much of it as of its stiffness",
                      .low = 0.0,
                      .high = 1.0,
                      .neutral = kNoNeutral,
                      .fallback = 0.0}};

  StiffnessDegradation(std::span<const double> values, double /*sample_period_s*/)
      : half_life_{values[0]}, strength_exponent_{values[1]} {}
  void before(const StageSample& sample, Motion& motion) noexcept override {
    const double left = 1.0 / (1.0 + driver_.after(sample) / half_life_);
    if (left != stiffness_left_) {
      stiffness_left_ = left;
      strength_left_ = strength_exponent_ == 0.0 ? 1.0 : std::pow(left, strength_exponent_);
    }
    motion.displacement_m *= stiffness_left_ / strength_left_;
    motion.velocity_m_per_s *= stiffness_left_ / strength_left_;
  }
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& force_n) noexcept override {
    force_n *= strength_left_;
  }
  void reset() noexcept override {
    driver_ = {};
    stiffness_left_ = 1.0;
    strength_left_ = 1.0;
  }

 private:
  double half_life_;
  double strength_exponent_;
  double stiffness_left_ = 1.0;
  double strength_left_ = 1.0;
  Driver driver_;
};

}  // namespace hybridtest
