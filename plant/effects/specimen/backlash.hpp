#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Play between actuator and specimen that moves along with the last reversal (Tao and Kokotovic, Adaptive
/// Control of Systems with Actuator and Sensor Nonlinearities, 1996, chapter 2; Nordin and Gutman,
/// Automatica 38, 2002). After a reversal the specimen goes back with the actuator until its force has
/// fallen to the share h of what it was, then it stands still over the clearance, until the other flank
/// carries it. h = 1: held by friction it stands still at once, which is the play operator; h = 0: it
/// stands still once it is unloaded, as a friction damper with loose bolts does.
///
/// The force is that of the law and of the effects in front of it in the list; friction moves with the specimen,
/// viscous and inertia forces are those of the actuator.
class SpecimenBacklash final : public Effect {
 public:
  static constexpr std::string_view kEquation =
      "F = F0(y), y = x -+ c/2 on a flank, still between; leaves it at F0 = h Fr";
  static constexpr std::string_view kSource = "Tao and Kokotovic (1996), chapter 2";
  static constexpr EffectTraits kTraits{.family = EffectFamily::amplitude};
  static constexpr std::array kParameters{
      EffectParameter{
          .name = "clearance_m", .unit = "m", .what = "c, from one side to the other", .low = 0.0, .high = kUnbounded},
      EffectParameter{.name = "holding_ratio",
                      .unit = "",
                      .what = "h, 1: play operator, 0: gap once unloaded",
                      .low = 0.0,
                      .high = 1.0,
                      .neutral = kNoNeutral,
                      .fallback = 1.0}};

  SpecimenBacklash(std::span<const double> values, double /*sample_period_s*/)
      : half_clearance_m_{0.5 * values[0]}, holding_ratio_{values[1]} {}
  void before(const StageSample& sample, Motion& motion) noexcept override;
  void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& force_n) noexcept override {
    force_n_ = force_n;
  }
  void reset() noexcept override;

 private:
  double half_clearance_m_;
  double holding_ratio_;
  double side_ = 0.0;        // of the flank that carries the specimen: 1 pushes, -1 pulls, 0 none
  double position_m_ = 0.0;  // of the specimen
  double actuator_m_ = 0.0;
  double force_n_ = 0.0;
  bool goes_back_ = false;         // the actuator, from the flank
  double reversal_force_n_ = 0.0;  // when it began to
};

}  // namespace hybridtest
