#pragma once

#include <array>
#include <cmath>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// The specimen's law loses strength the further it has travelled (Baber and Wen, J. Eng. Mech. Div. ASCE
/// 107, 1981, whose nu grows with the dissipated energy), and keeps its elastic stiffness: a law that does not
/// yield has no strength to lose.
class StrengthDegradation final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = s F0(x / s), s = exp(-S / L), S = travelled path";
  static constexpr std::string_view kSource = "after Baber and Wen (1981)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::degradation};
  static constexpr std::array kParameters{EffectParameter{.name = "path_m",
                                                          .unit = "m",
                                                          .what = "L, path after which 37 % of the strength are left",
                                                          .low = 1e-9,
                                                          .high = kUnbounded,
                                                          .neutral = kUnbounded}};

  StrengthDegradation(std::span<const double> values, double /*sample_period_s*/) : decay_path_m_{values[0]} {}
  void before(const StageSample& sample, Motion& motion) noexcept override {
    path_m_ += std::abs(sample.motion.displacement_m - displacement_m_);
    displacement_m_ = sample.motion.displacement_m;
    left_ = std::exp(-path_m_ / decay_path_m_);
    motion.displacement_m /= left_;
    motion.velocity_m_per_s /= left_;
  }
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& force_n) noexcept override {
    force_n *= left_;
  }
  void reset() noexcept override {
    path_m_ = displacement_m_ = 0.0;
    left_ = 1.0;
  }

 private:
  double decay_path_m_;
  double path_m_ = 0.0;
  double left_ = 1.0;
  double displacement_m_ = 0.0;
};

}  // namespace hybridtest
