#pragma once

#include <array>
#include <cmath>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Reaction frame and clevis give way under the specimen's force (Dyke, Spencer, Quast and Sain, J. Eng. Mech.
/// 121, 1995). Pins and bolted joints have play: until a force has closed them, the frame gives more. The force is that
/// of the sample before: stable while compliance times stiffness of the specimen stays below 1.
class Compliance final : public Effect {
 public:
  static constexpr std::string_view kEquation = "x = x0 - c (r F + (1 - r) Fc tanh(F / Fc))";
  static constexpr std::string_view kSource = "Dyke et al. (1995), with joints that close";
  static constexpr EffectTraits kTraits{.family = EffectFamily::load};
  static constexpr std::array kParameters{EffectParameter{.name = "compliance_m_per_n",
                                                          .unit = "m/N",
                                                          .what = "c, of frame and clevis while its joints are open",
                                                          .low = 0.0,
                                                          .high = 1.0,
                                                          .is_linear = true},
                                          EffectParameter{.name = "closed_joint_ratio",
                                                          .unit = "",
                                                          .what = "r, give of closed joints over that of open ones",
                                                          .low = 0.0,
                                                          .high = 1.0,
                                                          .neutral = kNoNeutral,
                                                          .fallback = 1.0},
                                          EffectParameter{.name = "closing_force_n",
                                                          .unit = "N",
                                                          .what = "Fc, about which joints close; 0: from the start",
                                                          .low = 0.0,
                                                          .high = kUnbounded,
                                                          .neutral = kNoNeutral,
                                                          .fallback = 0.0}};

  Compliance(std::span<const double> values, double /*sample_period_s*/)
      : closed_m_per_n_{values[0] * values[1]},
        taken_up_m_{values[0] * (1.0 - values[1]) * values[2]},
        closing_force_n_{values[2]} {}
  void after(const StageSample& sample, const Motion& /*motion*/, double& displacement_m) noexcept override {
    displacement_m -= closed_m_per_n_ * sample.force_n;
    if (taken_up_m_ > 0.0) displacement_m -= taken_up_m_ * std::tanh(sample.force_n / closing_force_n_);
  }
  void reset() noexcept override {}

 private:
  double closed_m_per_n_;
  double taken_up_m_;  // by the joints in closing
  double closing_force_n_;
};

}  // namespace hybridtest
