#pragma once

#include <array>

#include "experimental_site/effects/effect_type.hpp"
#include "experimental_site/effects/parameter_limits.hpp"

namespace hybridtest {

/// The specimen is stiffer than its model by dk, or softer where that is negative: a spring beside
/// the model's law.
class StiffnessError final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0 + dk x";
  static constexpr std::string_view kSource = "Hooke's law; a wrong number of the user's model";
  static constexpr std::array kParameters{EffectParameter{.name = "stiffness_n_per_m",
                                                          .unit = "N/m",
                                                          .what = "dk, real less model stiffness",
                                                          .low = -kUnbounded,
                                                          .high = kUnbounded,
                                                          .scale = ParameterScale::stiffness_n_per_m,
                                                          .search_low = -2.0,
                                                          .search_high = 2.0,
                                                          .is_linear = true}};

  StiffnessError(std::span<const double> values, double /*sample_period_s*/) : stiffness_n_per_m_{values[0]} {}
  void after(const StageSample& /*sample*/, const Motion& motion, double& force_n) noexcept override {
    force_n += stiffness_n_per_m_ * motion.displacement_m;
  }
  void reset() noexcept override {}

 private:
  double stiffness_n_per_m_;
};

}  // namespace hybridtest
