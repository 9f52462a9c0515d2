#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Reaction frame and clevis give way under the specimen's force (Dyke, Spencer, Quast and Sain, J. Eng. Mech.
/// 121, 1995). The force is that of the sample before: stable while compliance times stiffness of the
/// specimen stays below 1.
class Compliance final : public Effect {
 public:
  static constexpr std::string_view kEquation = "x = x0 - F / kf";
  static constexpr std::string_view kSource = "Dyke et al. (1995)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::load};
  static constexpr std::array kParameters{EffectParameter{.name = "compliance_m_per_n",
                                                          .unit = "m/N",
                                                          .what = "1 / kf, of frame and clevis",
                                                          .low = 0.0,
                                                          .high = 1.0,
                                                          .is_linear = true}};

  Compliance(std::span<const double> values, double /*sample_period_s*/) : compliance_m_per_n_{values[0]} {}
  void after(const StageSample& sample, const Motion& /*motion*/, double& displacement_m) noexcept override {
    displacement_m -= compliance_m_per_n_ * sample.force_n;
  }
  void reset() noexcept override {}

 private:
  double compliance_m_per_n_;
};

}  // namespace hybridtest
