#include "validation/studies/compensator_character/driven_target.hpp"

#include <cmath>
#include <numbers>

namespace hybridtest::character {

DrivenTarget::DrivenTarget(double amplitude_m, double frequency_hz)
    : amplitude_m_{amplitude_m}, omega_{2.0 * std::numbers::pi * frequency_hz} {}

Motion DrivenTarget::at(double time_s) const noexcept {
  const double sine = std::sin(omega_ * time_s);
  const double cosine = std::cos(omega_ * time_s);
  double share = 1.0;
  double rate = 0.0;
  double curvature = 0.0;
  if (time_s < 1.0) {
    share = time_s * time_s * (3.0 - 2.0 * time_s);
    rate = 6.0 * time_s * (1.0 - time_s);
    curvature = 6.0 - 12.0 * time_s;
  }
  return {amplitude_m_ * share * sine, amplitude_m_ * (rate * sine + share * omega_ * cosine),
          amplitude_m_ * (curvature * sine + 2.0 * rate * omega_ * cosine - share * omega_ * omega_ * sine)};
}

MeasuredLoop::MeasuredLoop(const CompensationMethod& method, const StandKind& stand)
    : has_loop_delay_{stand.has_loop_delay},
      stand_{stand.make()},
      compensator_{method.make_compensator(stand.delay_s, stand.period_s)},
      force_compensator_{method.make_force_compensator(stand.delay_s, stand.period_s)} {}

LoopSample MeasuredLoop::advance(const Motion& target, const Disturbance& disturbance) noexcept {
  const double target_m = target.displacement_m + disturbance.target_m;
  const Measured now{stand_->displacement_m() + disturbance.measured_displacement_m,
                     stand_->force_n() + disturbance.measured_force_n};
  const Measured& acting = has_loop_delay_ ? before_ : now;
  LoopSample sample;
  sample.structure_force_n = force_compensator_->corrected_force({target_m, acting.displacement_m, acting.force_n});
  sample.command_m = compensator_->command(
      {target_m, target.velocity_m_per_s, target.acceleration_m_per_s2, before_.displacement_m, before_.force_n});
  stand_->step(sample.command_m);
  before_ = now;
  return sample;
}

}  // namespace hybridtest::character
