#pragma once

#include <algorithm>
#include <array>

#include "experimental_site/effects/effect_type.hpp"
#include "experimental_site/effects/parameter_limits.hpp"

namespace hybridtest {

/// Play between actuator and specimen (Tao and Kokotovic, Adaptive Control of Systems with Actuator and Sensor
/// Nonlinearities, 1996, chapter 2): after each reversal the specimen stands still over the clearance.
/// Friction holds it there, so the play moves along with the last reversal; viscous and inertia forces
/// are those of the actuator.
class SpecimenBacklash final : public Effect {
 public:
  static constexpr std::string_view kEquation = "F = F0(y), y = clamp(y, x - c/2, x + c/2)";
  static constexpr std::string_view kSource = "Tao and Kokotovic (1996), chapter 2";
  static constexpr std::array kParameters{EffectParameter{.name = "clearance_m",
                                                          .unit = "m",
                                                          .what = "c, from one side to the other",
                                                          .low = 0.0,
                                                          .high = kUnbounded,
                                                          .scale = ParameterScale::displacement_m,
                                                          .search_low = 0.005,
                                                          .search_high = 1.0}};

  SpecimenBacklash(std::span<const double> values, double /*sample_period_s*/) : half_clearance_m_{0.5 * values[0]} {}
  void before(const StageSample& /*sample*/, Motion& motion) noexcept override {
    const double low_m = motion.displacement_m - half_clearance_m_;
    const double high_m = motion.displacement_m + half_clearance_m_;
    const bool is_carried = position_m_ <= low_m || position_m_ >= high_m;
    position_m_ = std::clamp(position_m_, low_m, high_m);
    motion.displacement_m = position_m_;
    if (!is_carried) motion.velocity_m_per_s = motion.acceleration_m_per_s2 = 0.0;
  }
  void reset() noexcept override { position_m_ = 0.0; }

 private:
  double half_clearance_m_;
  double position_m_ = 0.0;  // of the specimen
};

}  // namespace hybridtest
