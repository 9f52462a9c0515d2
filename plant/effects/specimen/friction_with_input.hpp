#pragma once

#include <array>

#include "mechanics/laws/presliding_element.hpp"
#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"
#include "plant/effects/recorded_input.hpp"

namespace hybridtest {

/// Dry friction that grows with a recorded input, as the yield force of a magnetorheological damper with its current
/// (Spencer, Dyke, Sain and Carlson, J. Eng. Mech. 123, 1997). What it is at u0 is friction of its own, or the model's.
class FrictionWithInput final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + f (u - u0) z, dz = dx / d, |z| <= 1";
  static constexpr std::string_view kSource = "Coulomb (1785); Spencer, Dyke, Sain and Carlson (1997)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::amplitude, .takes_input = true};
  static constexpr std::array kParameters{EffectParameter{.name = "friction_force_n_per_unit",
                                                          .unit = "N per unit",
                                                          .what = "f, while sliding, per unit of the input",
                                                          .low = -kUnbounded,
                                                          .high = kUnbounded,
                                                          .is_linear = true},
                                          EffectParameter{.name = "presliding_displacement_m",
                                                          .unit = "m",
                                                          .what = "d, until it slides",
                                                          .low = 1e-12,
                                                          .high = kUnbounded,
                                                          .neutral = kNoNeutral,
                                                          .fallback = 1e-5},
                                          kReferenceInput, kNominalInput};

  FrictionWithInput(std::span<const double> values, double /*sample_period_s*/)
      : friction_force_n_per_unit_{values[0]}, element_{values[1]}, input_{values[2], values[3]} {}
  void follow_input(std::size_t position) noexcept override { input_.follow(position); }
  void after(const StageSample& sample, const Motion& motion, double& force_n) noexcept override {
    force_n += friction_force_n_per_unit_ * input_.beyond_reference(sample) * element_.share(motion.displacement_m);
  }
  void reset() noexcept override { element_.reset(); }

 private:
  double friction_force_n_per_unit_;
  PreslidingElement element_;
  RecordedInput input_;
};

}  // namespace hybridtest
