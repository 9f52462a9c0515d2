#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"

namespace hybridtest {

/// The actuator goes further than it is told, or less far where e is negative: a static error of
/// its controller (Carrion and Spencer, NSEL-006, 2007, section 4.2: amplitude error).
class TransferGain final : public Effect {
 public:
  static constexpr std::string_view kEquation = "x = (1 + e) x0";
  static constexpr std::string_view kSource = "Carrion and Spencer (2007), section 4.2";
  static constexpr EffectTraits kTraits{.family = EffectFamily::scale, .number = ModelNumber::gain};
  static constexpr std::array kParameters{EffectParameter{.name = "gain_error",
                                                          .unit = "",
                                                          .what = "e, share by which it goes too far",
                                                          .low = -2.0,
                                                          .high = 10.0,
                                                          .is_linear = true}};

  TransferGain(std::span<const double> values, double /*sample_period_s*/) : factor_{1.0 + values[0]} {}
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& displacement_m) noexcept override {
    displacement_m *= factor_;
  }
  void reset() noexcept override {}

 private:
  double factor_;
};

}  // namespace hybridtest
