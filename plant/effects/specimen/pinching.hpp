#pragma once

#include <array>
#include <cmath>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// The specimen's force is less around zero displacement, as where cracks and loose bolts have to close before they
/// carry (the slip function of Baber and Noori, J. Vib. Acoust. 108, 1986, in displacements).
class Pinching final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 (1 - p exp(-(x / w)^2))";
  static constexpr std::string_view kSource = "after Baber and Noori (1986)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::amplitude, .bends_curve = true};
  static constexpr std::array kParameters{EffectParameter{.name = "pinching_ratio",
                                                          .unit = "",
                                                          .what = "p, of the force that is missing at zero",
                                                          .low = 0.0,
                                                          .high = 1.0,
                                                          .is_linear = true},
                                          EffectParameter{.name = "pinching_width_m",
                                                          .unit = "m",
                                                          .what = "w, where 37 % of that are missing",
                                                          .low = 1e-9,
                                                          .high = kUnbounded,
                                                          .neutral = kNoNeutral}};

  Pinching(std::span<const double> values, double /*sample_period_s*/)
      : pinching_ratio_{values[0]}, pinching_width_m_{values[1]} {}
  void after(const StageSample& /*sample*/, const Motion& motion, double& force_n) noexcept override {
    const double share = motion.displacement_m / pinching_width_m_;
    force_n *= 1.0 - pinching_ratio_ * std::exp(-share * share);
  }
  void reset() noexcept override {}

 private:
  double pinching_ratio_;
  double pinching_width_m_;
};

}  // namespace hybridtest
