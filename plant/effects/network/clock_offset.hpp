#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"
#include "plant/transfer_systems/delay_line.hpp"

namespace hybridtest {

/// The clock of the site is behind that of the coordinator: it plays the targets late (Mills, RFC 5905, 2010). Ahead it
/// cannot be, since it would need targets that are not sent yet.
class ClockOffset final : public Effect {
 public:
  static constexpr std::string_view kEquation = "u(t) = u0(t - d)";
  static constexpr std::string_view kSource = "Mills (2010)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::arrival, .needs_time = true};
  static constexpr std::array kParameters{EffectParameter{
      .name = "offset_s", .unit = "s", .what = "d, by which its clock is behind", .low = 0.0, .high = 10.0}};

  ClockOffset(std::span<const double> values, double sample_period_s) : line_{values[0], sample_period_s} {}
  void before(const StageSample& /*sample*/, Motion& target) noexcept override {
    line_.push(target.displacement_m);
    target.displacement_m = line_.delayed();
  }
  void reset() noexcept override { line_.reset(); }

 private:
  DelayLine line_;
};

}  // namespace hybridtest
