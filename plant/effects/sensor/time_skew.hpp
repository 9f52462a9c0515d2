#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"
#include "plant/transfer_systems/delay_line.hpp"

namespace hybridtest {

/// The force is recorded later than the displacement it belongs to, as of a slower converter (Stearns and Hush,
/// Digital Signal Processing with Examples in MATLAB, 2011).
class TimeSkew final : public Effect {
 public:
  static constexpr std::string_view kEquation = "r(t) = y(t - s)";
  static constexpr std::string_view kSource = "channels sampled one after the other";
  static constexpr EffectTraits kTraits{.family = EffectFamily::rate, .needs_time = true};
  static constexpr std::array kParameters{EffectParameter{
      .name = "skew_s", .unit = "s", .what = "s, by which the force is late", .low = 0.0, .high = 10.0}};

  TimeSkew(std::span<const double> values, double sample_period_s) : line_{values[0], sample_period_s} {}
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& force_n) noexcept override {
    line_.push(force_n);
    force_n = line_.delayed_smoothly();
  }
  void reset() noexcept override { line_.reset(); }

 private:
  DelayLine line_;
};

}  // namespace hybridtest
