#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// The seals hold the actuator until it is asked to go further than s, then it slips to where it should be: what it is
/// behind dies away with a time constant T, and it follows until the next reversal (Karnopp, J. Dyn. Sys. Meas. Control
/// 107, 1985, in displacements). The lag of its loop besides is the transfer system's own.
class Stiction final : public Effect {
 public:
  static constexpr std::string_view kEquation =
      "x holds after a reversal of x0 until |x0 - x| > s, then x0 - x = e, T e' = -e";
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
        decay_{values[1] > 0.0 ? sample_period_s / values[1] : std::numeric_limits<double>::infinity()},
        kept_{std::exp(-decay_)} {}
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& displacement_m) noexcept override {
    const double travel_m = displacement_m - asked_m_;
    asked_m_ = displacement_m;
    if (slips_ && travel_m * travel_before_m_ < 0.0) slips_ = false;
    if (travel_m != 0.0) travel_before_m_ = travel_m;
    if (slips_) {
      behind_m_ *= kept_;
    } else {
      behind_m_ += travel_m;
      const double beyond_m = std::abs(behind_m_) - stick_displacement_m_;
      slips_ = beyond_m > 0.0;
      if (slips_) {
        const double share = beyond_m / std::abs(travel_m);  // of the sample, since when
        behind_m_ = std::copysign(stick_displacement_m_ * std::exp(-decay_ * share), behind_m_);
      }
    }
    displacement_m -= behind_m_;
  }
  void reset() noexcept override {
    behind_m_ = asked_m_ = travel_before_m_ = 0.0;
    slips_ = false;
  }

 private:
  double stick_displacement_m_;
  double decay_;  // of what it is behind, in a sample
  double kept_;
  double behind_m_ = 0.0;
  double asked_m_ = 0.0;
  double travel_before_m_ = 0.0;
  bool slips_ = false;
};

}  // namespace hybridtest
