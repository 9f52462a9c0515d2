#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// The compensator makes up for another delay than its setting says (Wallace, Sieber, Neild, Wagg and Krauskopf,
/// Earthquake Eng. Struct. Dyn. 34, 2005: a forward prediction by a wrong time): its command is that of another
/// instant. Of a compensator whose setting a model of the site knows (SiteModel) the setting itself is changed, of
/// `none` to a polynomial of order 3; else, and in a rig, which sees only the command, it is to first order in the
/// difference, with the second-order backward difference for the rate.
class SettingMismatch final : public Effect {
 public:
  static constexpr std::string_view kEquation = "u = u0 + e u0'";
  static constexpr std::string_view kSource = "Wallace et al. (2005)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::rate, .needs_time = true};
  static constexpr std::array kParameters{EffectParameter{
      .name = "delay_error_s", .unit = "s", .what = "e, made up for beyond its setting", .low = -10.0, .high = 10.0}};

  SettingMismatch(std::span<const double> values, double sample_period_s)
      : error_samples_{values[0] / sample_period_s} {}
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& command_m) noexcept override {
    const double rise_m = 1.5 * command_m - 2.0 * before_m_ + 0.5 * long_before_m_;
    long_before_m_ = before_m_;
    before_m_ = command_m;
    command_m += error_samples_ * rise_m;
  }
  void reset() noexcept override { before_m_ = long_before_m_ = 0.0; }

 private:
  double error_samples_;
  double before_m_ = 0.0;
  double long_before_m_ = 0.0;
};

}  // namespace hybridtest
