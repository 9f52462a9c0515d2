#pragma once

namespace hybridtest {

/// From the command displacement of one actuator to the displacement it imposes.
///
/// Stepped once per control sample; between samples the command is taken as a straight line,
/// so that every transfer system tends to `ideal` as it gets faster. One that says so takes it otherwise.
class TransferSystem {
 public:
  virtual ~TransferSystem() = default;

  /// Actuator displacement [m] at this sample, the command displacement [m] at this sample given.
  [[nodiscard]] virtual double step(double command_m) noexcept = 0;
  /// The same under the force [N] with which the specimen resists, of the sample before; one that no
  /// load moves does not look at it.
  [[nodiscard]] virtual double step_loaded(double command_m, double /*load_force_n*/) noexcept {
    return step(command_m);
  }
  /// With which a specimen that is part of it resists, at the last step [N]; 0 where the specimen is a part by itself.
  [[nodiscard]] virtual double specimen_force_n() const noexcept { return 0.0; }
  /// At rest at zero displacement.
  virtual void reset() noexcept = 0;
};

}  // namespace hybridtest
