#pragma once

#include <cstddef>
#include <optional>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// The input u0 at which an effect is absent: there the model beside it is right.
inline constexpr EffectParameter kReferenceInput{.name = "reference_input",
                                                 .unit = "",
                                                 .what = "u0, where the effect is absent, in the unit of the input",
                                                 .low = -kUnbounded,
                                                 .high = kUnbounded,
                                                 .neutral = kNoNeutral,
                                                 .fallback = 0.0};
/// The input where none is recorded: a simulated rig has none.
inline constexpr EffectParameter kNominalInput{.name = "nominal_input",
                                               .unit = "",
                                               .what = "u where none is recorded: in a simulated rig",
                                               .low = -kUnbounded,
                                               .high = kUnbounded,
                                               .neutral = kNoNeutral};

/// A recorded input as an effect sees it.
class RecordedInput {
 public:
  RecordedInput(double reference, double nominal) : reference_{reference}, nominal_{nominal} {}

  void follow(std::size_t position) noexcept { position_ = position; }
  /// u - u0.
  [[nodiscard]] double beyond_reference(const StageSample& sample) const noexcept {
    const bool is_recorded = position_.has_value() && sample.inputs != nullptr;
    return (is_recorded ? sample.inputs[*position_] : nominal_) - reference_;
  }

 private:
  double reference_;
  double nominal_;
  std::optional<std::size_t> position_;
};

}  // namespace hybridtest
