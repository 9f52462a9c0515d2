#pragma once

namespace hybridtest {

/// What a compensator sees at one control sample, one degree of freedom.
struct CompensatorInput {
  double target_m = 0.0;                      // [m] where the actuator should be at this sample
  double target_velocity_m_per_s = 0.0;       // [m/s] integrator's own
  double target_acceleration_m_per_s2 = 0.0;  // [m/s2] integrator's own
  double measured_displacement_m = 0.0;       // [m] newest measurement, one sample old
  double measured_force_n = 0.0;              // [N] likewise
};

/// Makes up for the dynamics of the transfer system: turns the target displacement into the
/// command that brings the actuator to the target at its time. One instance per degree of
/// freedom, called once per control sample.
///
/// Values that are not finite: where the method uses it, a non-finite target makes the command
/// non-finite, so that interlocks see it, for as long as it is in the method's history and no
/// longer. A non-finite measurement is skipped and never reaches the command.
class Compensator {
 public:
  virtual ~Compensator() = default;

  /// The command displacement [m] for this sample. Allocates nothing.
  [[nodiscard]] virtual double command(const CompensatorInput& input) noexcept = 0;
  /// Back to what it was when new: no history, nothing learnt.
  virtual void reset() noexcept = 0;
};

}  // namespace hybridtest
