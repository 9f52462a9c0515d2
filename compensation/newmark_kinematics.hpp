#pragma once

#include "compensation/compensator.hpp"
#include "compensation/delay_adaptive.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Kinematics of Newmark's explicit step, carried beyond the step by the delay (founding study,
/// equation 7; Ahmadizadeh, Mosqueda and Reinhorn, Earthquake Engng Struct. Dyn. 37, 2008):
///
///     command = x0 + v0 (dt + delay) + a0/2 (dt + delay)^2
///
/// with the integrator's own displacement, velocity and acceleration. dt is the time from the
/// state that the integrator hands over to the target it stands for: the integration step where
/// that is the state at the beginning of the step, as in the study, zero where it is the target's
/// own, as in this project's control loop.
///
/// Exact for constant acceleration; the identity at zero delay and zero step. No history.
class NewmarkKinematics final : public Compensator, public DelayAdaptive {
 public:
  static constexpr double kDelaySMax = 1.0;
  struct Parameters {
    double delay_s = 0.020;
    double step_s = 0.0;  // dt

    void serialize(ParameterArchive& archive) {
      archive.required("delay_s", delay_s,
                       {{.low = 0.0, .high = kDelaySMax}, "to make up for", "acceleration is not constant for longer"});
      archive.optional("step_s", step_s,
                       {kZeroToOne, "0 where velocity and acceleration are those of the target, as in a scenario",
                        "it is the integration step or zero"});
    }
  };

  /// @throws ConfigError for values outside their ranges.
  NewmarkKinematics(const Parameters& parameters, double control_period_s);

  [[nodiscard]] double command(const CompensatorInput& input) noexcept override;
  void reset() noexcept override { set_delay(parameters_.delay_s); }

  void set_delay(double delay_s) noexcept override;
  [[nodiscard]] double delay_s() const noexcept override { return delay_s_; }
  [[nodiscard]] double delay_s_max() const noexcept override { return kDelaySMax; }

 private:
  Parameters parameters_;
  double delay_s_ = 0.0;
};

}  // namespace hybridtest
