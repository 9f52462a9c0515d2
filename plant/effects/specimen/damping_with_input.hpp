#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"
#include "plant/effects/recorded_input.hpp"

namespace hybridtest {

/// A dashpot that grows with a recorded input, as that of a magnetorheological damper with its current (Spencer, Dyke,
/// Sain and Carlson, J. Eng. Mech. 123, 1997). What it is at u0 is damping of its own, or the model's.
class DampingWithInput final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + c (u - u0) v";
  static constexpr std::string_view kSource = "Spencer, Dyke, Sain and Carlson (1997)";
  static constexpr EffectTraits kTraits{
      .family = EffectFamily::rate, .follows_derivatives = true, .needs_time = true, .takes_input = true};
  static constexpr std::array kParameters{EffectParameter{.name = "damping_n_s_per_m_per_unit",
                                                          .unit = "N s/m per unit",
                                                          .what = "c, per unit of the input",
                                                          .low = -kUnbounded,
                                                          .high = kUnbounded,
                                                          .is_linear = true},
                                          kReferenceInput, kNominalInput};

  DampingWithInput(std::span<const double> values, double /*sample_period_s*/)
      : damping_n_s_per_m_per_unit_{values[0]}, input_{values[1], values[2]} {}
  void follow_input(std::size_t position) noexcept override { input_.follow(position); }
  void after(const StageSample& sample, const Motion& /*motion*/, double& force_n) noexcept override {
    force_n += damping_n_s_per_m_per_unit_ * input_.beyond_reference(sample) * sample.motion.velocity_m_per_s;
  }
  void reset() noexcept override {}

 private:
  double damping_n_s_per_m_per_unit_;
  RecordedInput input_;
};

}  // namespace hybridtest
