#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"
#include "plant/effects/specimen/degradation_drivers.hpp"

namespace hybridtest {

/// The specimen gets softer with what it went through (Baber and Wen, J. Eng. Mech. Div. ASCE 107, 1981, whose eta
/// grows with the dissipated energy; Park and Ang, J. Struct. Eng. 111, 1985; Krawinkler and Zohrei, Computers &
/// Structures 16, 1983; Makris, J. Eng. Mech. 124, 1998): its law sees a displacement that shrinks by a half once the
/// driver has come to L. A law that yields keeps its strength.
template <class Driver>
class StiffnessDegradation final : public Effect {
 public:
  static constexpr std::string_view kEquation = Driver::kStiffness.equation;
  static constexpr std::string_view kSource = Driver::kSource;
  static constexpr EffectTraits kTraits{.family = EffectFamily::degradation, .needs_time = Driver::kNeedsTime};
  static constexpr std::array kParameters{EffectParameter{.name = Driver::kStiffness.parameter,
                                                          .unit = Driver::kUnit,
                                                          .what = Driver::kStiffness.what,
                                                          .low = 1e-9,
                                                          .high = kUnbounded,
                                                          .neutral = kUnbounded}};

  StiffnessDegradation(std::span<const double> values, double /*sample_period_s*/) : half_life_{values[0]} {}
  void before(const StageSample& sample, Motion& motion) noexcept override {
    const double left = 1.0 / (1.0 + driver_.after(sample) / half_life_);
    motion.displacement_m *= left;
    motion.velocity_m_per_s *= left;
  }
  void reset() noexcept override { driver_ = {}; }

 private:
  double half_life_;
  Driver driver_;
};

}  // namespace hybridtest
