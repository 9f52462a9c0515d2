#pragma once

#include <array>

#include "experimental_site/effects/effect_type.hpp"
#include "experimental_site/effects/parameter_limits.hpp"
#include "mechanics/gap_spring.hpp"

namespace hybridtest {

/// A spring beside the model's law that acts beyond a gap on either side, at a fixed position (Chopra,
/// Dynamics of Structures, 2012, section 22.1). With a negative stiffness: a part of the specimen that
/// stops acting.
class Gap final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + k (x - clamp(x, -g, g))";
  static constexpr std::string_view kSource = "Chopra (2012), section 22.1";
  static constexpr std::array kParameters{EffectParameter{.name = "stiffness_n_per_m",
                                                          .unit = "N/m",
                                                          .what = "k, beyond the gap",
                                                          .low = -kUnbounded,
                                                          .high = kUnbounded,
                                                          .scale = ParameterScale::stiffness_n_per_m,
                                                          .search_low = -5.0,
                                                          .search_high = 20.0,
                                                          .is_linear = true},
                                          EffectParameter{.name = "gap_m",
                                                          .unit = "m",
                                                          .what = "g, on either side",
                                                          .low = 0.0,
                                                          .high = kUnbounded,
                                                          .scale = ParameterScale::displacement_m,
                                                          .search_low = 0.02,
                                                          .search_high = 0.95,
                                                          .neutral = kNoNeutral}};

  Gap(std::span<const double> values, double /*sample_period_s*/) : stiffness_n_per_m_{values[0]}, gap_m_{values[1]} {}
  void after(const StageSample& /*sample*/, const Motion& motion, double& force_n) noexcept override {
    force_n += stiffness_n_per_m_ * beyond_gap_m(motion.displacement_m, gap_m_);
  }
  void reset() noexcept override {}

 private:
  double stiffness_n_per_m_;
  double gap_m_;
};

}  // namespace hybridtest
