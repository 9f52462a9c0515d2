#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"
#include "plant/transfer_systems/delay_line.hpp"

namespace hybridtest {

/// Targets reach the site later than the model has it, always by the same time (Mosqueda, Stojadinovic and Mahin,
/// EERC 2005-08).
class NetworkLatency final : public Effect {
 public:
  static constexpr std::string_view kEquation = "u(t) = u0(t - L)";
  static constexpr std::string_view kSource = "Mosqueda et al. (2005)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::arrival, .needs_time = true};
  static constexpr std::array kParameters{
      EffectParameter{.name = "latency_s", .unit = "s", .what = "L", .low = 0.0, .high = 10.0}};

  NetworkLatency(std::span<const double> values, double sample_period_s) : line_{values[0], sample_period_s} {}
  void before(const StageSample& /*sample*/, Motion& target) noexcept override {
    line_.push(target.displacement_m);
    target.displacement_m = line_.delayed();
  }
  void reset() noexcept override { line_.reset(); }

 private:
  DelayLine line_;
};

}  // namespace hybridtest
