#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// The specimen hardens more after yielding than its model says, or less, or softens. A law that yields is a spring
/// with a part b of its stiffness k beside an element that yields with the rest (Wen, 1976): a part e of that element
/// is replaced by a spring. Stiffness before yielding and yield displacement stay. Exact for laws of that form,
/// bilinear and Bouc-Wen among them, whose hardening ratio then is b + e (1 - b).
class HardeningError final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = (1 - e) F0 + e k x, k: initial stiffness of the law";
  static constexpr std::string_view kSource = "Wen (1976); a wrong number of the user's model";
  static constexpr EffectTraits kTraits{
      .family = EffectFamily::amplitude, .number = ModelNumber::hardening, .follows_stiffness = true};
  static constexpr std::array kParameters{
      EffectParameter{.name = "hardening_error_ratio",
                      .unit = "",
                      .what = "e, (real less model hardening) / (1 - model hardening)",
                      .low = -1.0,
                      .high = 1.0,
                      .neutral = 0.0,
                      .is_linear = true}};

  HardeningError(std::span<const double> values, double /*sample_period_s*/) : ratio_{values[0]} {}
  [[nodiscard]] bool is_of_base() const noexcept override { return true; }
  void follow_stiffness(double initial_n_per_m) noexcept override { stiffness_n_per_m_ = initial_n_per_m; }
  void before_base(Motion& motion) noexcept override { displacement_m_ = motion.displacement_m; }
  void after_base(double& force_n) noexcept override {
    force_n += ratio_ * (stiffness_n_per_m_ * displacement_m_ - force_n);
  }
  void reset() noexcept override { displacement_m_ = 0.0; }

 private:
  double ratio_;
  double stiffness_n_per_m_ = 0.0;
  double displacement_m_ = 0.0;  // that the law is given
};

}  // namespace hybridtest
