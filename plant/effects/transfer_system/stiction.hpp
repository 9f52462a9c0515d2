#pragma once

#include <array>
#include <cmath>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// The seals hold the actuator until it is asked to go further than s, then it slips to where it should be, which its
/// loop takes a time constant T for, and follows until the next reversal (Karnopp, J. Dyn. Sys. Meas. Control 107,
/// 1985, in displacements).
class Stiction final : public Effect {
 public:
  static constexpr std::string_view kEquation = "x holds after a reversal of x0 until |x0 - x| > s, then T x' = x0 - x";
  static constexpr std::string_view kSource = "after Karnopp (1985)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::amplitude};
  static constexpr std::array kParameters{EffectParameter{.name = "stick_displacement_m",
                                                          .unit = "m",
                                                          .what = "s, asked for before it slips",
                                                          .low = 0.0,
                                                          .high = kUnbounded},
                                          EffectParameter{.name = "slip_time_s",
                                                          .unit = "s",
                                                          .what = "T, to catch up in; 0: at once",
                                                          .low = 0.0,
                                                          .high = 1.0,
                                                          .fallback = 0.0}};

  Stiction(std::span<const double> values, double sample_period_s)
      : stick_displacement_m_{values[0]},
        slip_samples_{values[1] / sample_period_s},
        kept_{values[1] > 0.0 ? std::exp(-sample_period_s / values[1]) : 0.0} {}
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& displacement_m) noexcept override {
    const double travel_m = displacement_m - asked_m_;
    asked_m_ = displacement_m;
    if (slips_ && travel_m * travel_before_m_ < 0.0) slips_ = false;
    if (travel_m != 0.0) travel_before_m_ = travel_m;
    if (!slips_ && std::abs(displacement_m - position_m_) > stick_displacement_m_) slips_ = true;
    if (slips_ || stick_displacement_m_ == 0.0) {
      // Exact for what goes straight from sample to sample.
      const double behind_m = travel_m * slip_samples_;
      position_m_ = displacement_m - behind_m + kept_ * (position_m_ - (displacement_m - travel_m) + behind_m);
    }
    displacement_m = position_m_;
  }
  void reset() noexcept override {
    position_m_ = asked_m_ = travel_before_m_ = 0.0;
    slips_ = false;
  }

 private:
  double stick_displacement_m_;
  double slip_samples_;
  double kept_;  // of what it was away, per sample
  double position_m_ = 0.0;
  double asked_m_ = 0.0;
  double travel_before_m_ = 0.0;
  bool slips_ = false;
};

}  // namespace hybridtest
