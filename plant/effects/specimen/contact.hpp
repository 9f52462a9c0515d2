#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// A stop that the specimen meets (Chopra, Dynamics of Structures, 2012, section 22.1; a spring without tension):
/// beyond a positive position, or short of a negative one. Perhaps with another one on the other side.
class Contact final : public Effect {
 public:
  static constexpr std::string_view kEquation =
      "F = F0 + s k (max(0, s x - |p|) - r max(0, -s x - q |p|)), s = 1 for p >= 0, -1 for p < 0";
  static constexpr std::string_view kSource = "Chopra (2012), section 22.1";
  static constexpr EffectTraits kTraits{.family = EffectFamily::position, .bends_curve = true};
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
                                                          .neutral = kNoNeutral},
                                          EffectParameter{.name = "other_stiffness_ratio",
                                                          .unit = "",
                                                          .what = "r, of a stop on the other side, over k; 0: none",
                                                          .low = 0.0,
                                                          .high = kUnbounded,
                                                          .neutral = kNoNeutral,
                                                          .fallback = 0.0},
                                          EffectParameter{.name = "other_position_ratio",
                                                          .unit = "",
                                                          .what = "q, how far it is, over |p|",
                                                          .low = 0.0,
                                                          .high = kUnbounded,
                                                          .neutral = kNoNeutral,
                                                          .fallback = 1.0}};

  Contact(std::span<const double> values, double /*sample_period_s*/)
      : side_{values[1] >= 0.0 ? 1.0 : -1.0},
        stiffness_n_per_m_{values[0]},
        distance_m_{std::abs(values[1])},
        other_stiffness_ratio_{values[2]},
        other_distance_m_{values[3] * distance_m_} {}
  void after(const StageSample& /*sample*/, const Motion& motion, double& force_n) noexcept override {
    const double place_m = side_ * motion.displacement_m;
    const double beyond_m = std::max(0.0, place_m - distance_m_);
    const double beyond_other_m = std::max(0.0, -place_m - other_distance_m_);
    force_n += side_ * stiffness_n_per_m_ * (beyond_m - other_stiffness_ratio_ * beyond_other_m);
  }
  void reset() noexcept override {}

 private:
  double side_;
  double stiffness_n_per_m_;
  double distance_m_;
  double other_stiffness_ratio_;
  double other_distance_m_;
};

}  // namespace hybridtest
