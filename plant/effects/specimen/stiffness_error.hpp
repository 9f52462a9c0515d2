#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// The specimen is stiffer than its model says, or softer. Beside a linear spring, or none, that is a spring dk. Of a
/// law that yields the elastic stiffness is off by the ratio e, and the strength is not.
class StiffnessError final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0((1 + e) x) + dk x";
  static constexpr std::string_view kSource = "Hooke's law; a wrong number of the user's model";
  static constexpr EffectTraits kTraits{.family = EffectFamily::scale, .number = ModelNumber::stiffness};
  static constexpr std::array kParameters{EffectParameter{.name = "stiffness_error_ratio",
                                                          .unit = "",
                                                          .what = "e, real over the law's stiffness less 1",
                                                          .low = -1.0,
                                                          .high = kUnbounded,
                                                          .fallback = 0.0},
                                          EffectParameter{.name = "stiffness_n_per_m",
                                                          .unit = "N/m",
                                                          .what = "dk, real less model stiffness",
                                                          .low = -kUnbounded,
                                                          .high = kUnbounded,
                                                          .is_linear = true,
                                                          .fallback = 0.0}};

  StiffnessError(std::span<const double> values, double /*sample_period_s*/)
      : ratio_{1.0 + values[0]}, stiffness_n_per_m_{values[1]} {}
  [[nodiscard]] bool is_of_base() const noexcept override { return true; }
  void before_base(Motion& motion) noexcept override { motion.displacement_m *= ratio_; }
  void after(const StageSample& /*sample*/, const Motion& motion, double& force_n) noexcept override {
    force_n += stiffness_n_per_m_ * motion.displacement_m;
  }
  void reset() noexcept override {}

 private:
  double ratio_;
  double stiffness_n_per_m_;
};

}  // namespace hybridtest
