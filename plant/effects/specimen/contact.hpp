#pragma once

#include <algorithm>
#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// A stop that the specimen meets on one side (Chopra, Dynamics of Structures, 2012, section 22.1; a spring
/// without tension): beyond a positive position, or short of a negative one.
class Contact final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + k max(0, x - p) for p >= 0, F0 + k min(0, x - p) for p < 0";
  static constexpr std::string_view kSource = "Chopra (2012), section 22.1";
  static constexpr EffectTraits kTraits{.family = EffectFamily::position};
  static constexpr std::array kParameters{EffectParameter{.name = "stiffness_n_per_m",
                                                          .unit = "N/m",
                                                          .what = "k, of the stop",
                                                          .low = 0.0,
                                                          .high = kUnbounded,
                                                          .is_linear = true},
                                          EffectParameter{.name = "position_m",
                                                          .unit = "m",
                                                          .what = "p, where it is met",
                                                          .low = -kUnbounded,
                                                          .high = kUnbounded,
                                                          .neutral = kNoNeutral}};

  Contact(std::span<const double> values, double /*sample_period_s*/)
      : stiffness_n_per_m_{values[0]}, position_m_{values[1]} {}
  void after(const StageSample& /*sample*/, const Motion& motion, double& force_n) noexcept override {
    const double beyond_m = motion.displacement_m - position_m_;
    force_n += stiffness_n_per_m_ * (position_m_ >= 0.0 ? std::max(0.0, beyond_m) : std::min(0.0, beyond_m));
  }
  void reset() noexcept override {}

 private:
  double stiffness_n_per_m_;
  double position_m_;
};

}  // namespace hybridtest
