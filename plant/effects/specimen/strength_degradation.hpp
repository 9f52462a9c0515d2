#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"
#include "plant/effects/specimen/degradation_drivers.hpp"

namespace hybridtest {

/// The specimen's law loses strength with what it went through (Baber and Wen, J. Eng. Mech. Div. ASCE 107, 1981, whose
/// nu grows with the dissipated energy; the other drivers as for StiffnessDegradation), and keeps its elastic
/// stiffness: a law that does not yield has no strength to lose.
template <class Driver>
class StrengthDegradation final : public Effect {
 public:
  static constexpr std::string_view kEquation = Driver::kStrength.equation;
  static constexpr std::string_view kSource = Driver::kSource;
  static constexpr EffectTraits kTraits{.family = EffectFamily::degradation, .needs_time = Driver::kNeedsTime};
  static constexpr std::array kParameters{EffectParameter{.name = Driver::kStrength.parameter,
                                                          .unit = Driver::kUnit,
                                                          .what = Driver::kStrength.what,
                                                          .low = 1e-9,
                                                          .high = kUnbounded,
                                                          .neutral = kUnbounded}};

  StrengthDegradation(std::span<const double> values, double /*sample_period_s*/) : decay_{values[0]} {}
  void before(const StageSample& sample, Motion& motion) noexcept override {
    // Not to zero, where the displacement would be infinite.
    left_ = std::max(std::exp(-driver_.after(sample) / decay_), 1.0 / kUnbounded);
    motion.displacement_m /= left_;
    motion.velocity_m_per_s /= left_;
  }
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& force_n) noexcept override {
    force_n *= left_;
  }
  void reset() noexcept override {
    driver_ = {};
    left_ = 1.0;
  }

 private:
  double decay_;
  double left_ = 1.0;
  Driver driver_;
};

}  // namespace hybridtest
