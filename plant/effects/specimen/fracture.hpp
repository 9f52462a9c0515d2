#pragma once

#include <algorithm>
#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Part of the specimen breaks at an instant and carries nothing from then on (a member lost, as of
/// Kaewunruen and Remennikov, Eng. Failure Analysis 16, 2009): over one sample, so that the instant can be
/// found by its derivative.
class Fracture final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = (1 - r) F0 from t = tf on";
  static constexpr std::string_view kSource = "a member lost";
  static constexpr EffectTraits kTraits{.family = EffectFamily::degradation, .needs_time = true};
  static constexpr std::array kParameters{EffectParameter{.name = "lost_ratio",
                                                          .unit = "",
                                                          .what = "r, of the force that is lost",
                                                          .low = 0.0,
                                                          .high = 1.0,
                                                          .is_linear = true},
                                          EffectParameter{.name = "instant_s",
                                                          .unit = "s",
                                                          .what = "tf, since the beginning",
                                                          .low = 0.0,
                                                          .high = kUnbounded,
                                                          .neutral = kNoNeutral}};

  Fracture(std::span<const double> values, double sample_period_s)
      : lost_ratio_{values[0]}, instant_s_{values[1]}, sample_period_s_{sample_period_s} {}
  void after(const StageSample& sample, const Motion& /*motion*/, double& force_n) noexcept override {
    force_n *= 1.0 - lost_ratio_ * std::clamp((sample.time_s - instant_s_) / sample_period_s_, 0.0, 1.0);
  }
  void reset() noexcept override {}

 private:
  double lost_ratio_;
  double instant_s_;
  double sample_period_s_;
};

}  // namespace hybridtest
