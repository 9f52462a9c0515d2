#pragma once

#include <algorithm>
#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// A load cell or its amplifier at the end of its range (Figliola and Beasley, Theory and Design for Mechanical
/// Measurements, 2011, section 1.4).
class ForceSaturation final : public Effect {
 public:
  static constexpr std::string_view kEquation = "r = clamp(y, -m, m)";
  static constexpr std::string_view kSource = "Figliola and Beasley (2011), section 1.4";
  static constexpr EffectTraits kTraits{.family = EffectFamily::position};
  static constexpr std::array kParameters{EffectParameter{.name = "limit_n",
                                                          .unit = "N",
                                                          .what = "m, greatest reading",
                                                          .low = 1e-9,
                                                          .high = kUnbounded,
                                                          .neutral = kUnbounded}};

  ForceSaturation(std::span<const double> values, double /*sample_period_s*/) : limit_n_{values[0]} {}
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& force_n) noexcept override {
    force_n = std::clamp(force_n, -limit_n_, limit_n_);
  }
  void reset() noexcept override {}

 private:
  double limit_n_;
};

}  // namespace hybridtest
