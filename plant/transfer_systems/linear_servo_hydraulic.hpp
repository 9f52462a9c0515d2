#pragma once

#include "compensation/transfer_system_model.hpp"
#include "core/parameters/parameter_archive.hpp"
#include "core/time.hpp"
#include "plant/transfer_systems/transfer_system.hpp"

namespace hybridtest {

/// Servo-hydraulic actuator with its specimen, linear as it was identified: the plant of the virtual RTHS benchmark
/// (Silva, Gomez, Maghareh, Dyke and Spencer, Mech. Syst. Signal Process. 135, 2020), whose numbers are the defaults.
/// The equations are those of TransferSystemModel. The specimen's mass, damping and stiffness are part of them, so that
/// its rig takes `specimen: {type: in_transfer_system}` (SpecimenInTransferSystem).
///
/// Unlike the other transfer systems it holds its command from sample to sample, as a converter does: the displacement
/// at a sample is the answer to the commands of the samples before. The converter cuts commands at its range and rounds
/// them to its step.
///
/// Exact: the transition over a control period is a matrix exponential, so that the response at the samples does not
/// depend on the period. The benchmark's own Runge-Kutta of order 4 differs from it by (lambda h)^5 / 120 in a step.
class LinearServoHydraulic final : public TransferSystem {
 public:
  struct Parameters {
    TransferSystemModel model;
    double converter_range_m = 0.0;  // either way; 0: none
    double converter_step_m = 0.0;   // 0: none

    void serialize(ParameterArchive& archive) {
      model.serialize(archive);
      archive.optional("converter_range_m", converter_range_m, {kNotNegative, "of the commands, either way; 0: none"});
      archive.optional("converter_step_m", converter_step_m, {kNotNegative, "commands are rounded to it; 0: not"});
    }
  };

  /// @throws ConfigError for values outside their ranges.
  LinearServoHydraulic(const Parameters& parameters, Duration control_period);

  [[nodiscard]] double step(double command_m) noexcept override;
  /// Of the oil on specimen and piston, what the load cell reads [N].
  [[nodiscard]] double specimen_force_n() const noexcept override;
  void reset() noexcept override;

 private:
  [[nodiscard]] double converted(double command_m) const noexcept;

  Parameters parameters_;
  DiscreteTransferSystem over_period_;
  TransferSystemModel::State state_ = TransferSystemModel::State::Zero();  // scaled
  double held_command_m_ = 0.0;
};

}  // namespace hybridtest
