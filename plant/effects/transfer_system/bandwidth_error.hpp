#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"

namespace hybridtest {

/// The actuator of the model is right but for how fast it is: its bandwidth or natural frequency f0 is f0 (1 + e) in
/// reality, its damping ratio and its pure delay as the model has them (Zhao, French, Shield and Posbergh, Earthquake
/// Eng. Struct. Dyn. 32, 2003: it moves with the stiffness of the specimen and with wear of the valve). The
/// transfer system is made with that number (SiteModel); there is nothing left of it for this effect to do.
class BandwidthError final : public Effect {
 public:
  static constexpr std::string_view kEquation = "f = f0 (1 + e)";
  static constexpr std::string_view kSource = "Zhao et al. (2003)";
  static constexpr EffectTraits kTraits{
      .family = EffectFamily::rate, .number = ModelNumber::bandwidth, .needs_time = true};
  static constexpr std::array kParameters{EffectParameter{
      .name = "bandwidth_error_ratio", .unit = "", .what = "e, real over model, less 1", .low = -0.95, .high = 9.0}};

  BandwidthError(std::span<const double> /*values*/, double /*sample_period_s*/) {}
  void reset() noexcept override {}
};

}  // namespace hybridtest
