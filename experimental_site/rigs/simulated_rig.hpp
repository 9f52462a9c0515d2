#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/time.hpp"
#include "experimental_site/rigs/rig.hpp"
#include "plant/backward_differences.hpp"
#include "plant/sensors/noisy_sensor.hpp"
#include "plant/site_model.hpp"
#include "plant/site_stages.hpp"
#include "plant/specimens/specimen.hpp"
#include "plant/transfer_systems/transfer_system.hpp"

namespace hybridtest {

/// A simulated laboratory. Each actuator moves one degree of freedom of the specimen through its
/// transfer system; displacement and force are measured with noise. Effects of the library act at
/// their interface; those of network and compensator act on the command before the transfer system.
/// Velocity and acceleration of an actuator are second-order backward differences of its displacement.
///
/// After stop_motion() the rig holds its position and still measures. connect() resets everything,
/// noise included, so that a run can be repeated; arm() needs a connect() after the last
/// stop_motion(). These are faults: a command of the wrong size or with a number that is not finite
/// (the actuators do not move), a motion or force that overflows, and an exchange() before
/// connect(). With a fault the feedback is the last good one.
class SimulatedRig final : public Rig {
 public:
  using SensorNoise = hybridtest::SensorNoise;

  /// Of one actuator, see SiteModel.
  struct Effects {
    StageEffects network;
    StageEffects compensator;
    StageEffects transfer_system;
    StageEffects displacement_sensor;
    StageEffects specimen;
    StageEffects force_sensor;
  };
  /// @throws ConfigError as the effects.
  [[nodiscard]] static Effects effects_of(const SiteModel& model, double control_period_s);

  /// @param transfer_systems   one per actuator, as many as the specimen has dofs; none null.
  /// @param specimen           not null.
  /// @param control_period     from one exchange() to the next; positive.
  /// @param effects            one per actuator, or none at all.
  /// @throws ConfigError for values outside these ranges.
  SimulatedRig(std::vector<std::unique_ptr<TransferSystem>> transfer_systems, std::unique_ptr<Specimen> specimen,
               const SensorNoise& noise, Duration control_period, std::vector<Effects> effects = {});

  void connect() override;
  /// @throws std::runtime_error without a connect() before, or when stopped since then.
  void arm() override;
  [[nodiscard]] RigStatus exchange(const ActuatorCommand& command, RigFeedback& feedback) noexcept override;
  [[nodiscard]] RigFault fault() const noexcept override { return fault_; }
  void stop_motion() noexcept override;

 private:
  enum class Phase : std::uint8_t { disconnected, connected, armed, stopped };

  /// One degree of freedom, from its command to its transducers.
  struct Actuator {
    NetworkStage network;
    CompensatorStage compensator;
    TransferStage transfer;
    StageEffects specimen_effects;
    StageEffects force_sensor_effects;
    NoisySensor displacement_sensor;
    NoisySensor force_sensor;
    BackwardDifferences differences;
    Motion motion{};
    Motion given{};  // to the specimen, changed by its effects
    double read_m = 0.0;
  };

  [[nodiscard]] bool is_usable(const SiteVector& command_m) const noexcept;
  void move(Actuator& actuator, const StageSample& command, bool is_armed) noexcept;
  void load_specimen(double time_s) noexcept;
  [[nodiscard]] double read_force(Actuator& actuator, double time_s, double force_n) noexcept;

  std::unique_ptr<Specimen> specimen_;
  std::vector<Actuator> actuators_;
  double control_period_s_;
  RigFault fault_ = RigFault::unknown;
  std::atomic<Phase> phase_{Phase::disconnected};  // the only member that stop_motion() uses
  SiteVector displacement_m_;                      // this and the following: input of the specimen
  SiteVector velocity_m_per_s_;
  SiteVector force_n_;
};

}  // namespace hybridtest
