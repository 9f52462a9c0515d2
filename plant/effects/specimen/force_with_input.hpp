#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"
#include "plant/effects/recorded_input.hpp"

namespace hybridtest {

/// The force of the specimen, and of the effects in front of this one, grows with a recorded input: a temperature that
/// softens a bearing, the tension of a band.
class ForceWithInput final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 (1 + a (u - u0))";
  static constexpr std::string_view kSource = "first order of the force about u0 (Taylor)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::scale, .takes_input = true};
  static constexpr std::array kParameters{EffectParameter{.name = "force_ratio_per_unit",
                                                          .unit = "per unit",
                                                          .what = "a, share of the force per unit of the input",
                                                          .low = -kUnbounded,
                                                          .high = kUnbounded,
                                                          .is_linear = true},
                                          kReferenceInput, kNominalInput};

  ForceWithInput(std::span<const double> values, double /*sample_period_s*/)
      : ratio_per_unit_{values[0]}, input_{values[1], values[2]} {}
  void follow_input(std::size_t position) noexcept override { input_.follow(position); }
  void after(const StageSample& sample, const Motion& /*motion*/, double& force_n) noexcept override {
    force_n *= 1.0 + ratio_per_unit_ * input_.beyond_reference(sample);
  }
  void reset() noexcept override {}

 private:
  double ratio_per_unit_;
  RecordedInput input_;
};

}  // namespace hybridtest
