#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/time.hpp"
#include "experimental_site/rigs/rig.hpp"
#include "experimental_site/rigs/specimen.hpp"
#include "experimental_site/sensors/noisy_sensor.hpp"
#include "experimental_site/transfer_systems/transfer_system.hpp"

namespace hybridtest {

/// A laboratory in software: each actuator moves its degree of freedom of the specimen as its
/// transfer system lets it, and is measured with noise.
///
/// Once stopped it holds where it stands and still measures. connect() puts everything back to
/// new, noise included, so that a run can be repeated; arm() needs a connect() since the last
/// stop_motion(). A command of the wrong size or with a number that is not finite moves nothing
/// and is a fault; so is a motion or a force that grows beyond all numbers, or an exchange()
/// before connect(). With a fault the feedback is the last good one.
class SimulatedRig final : public Rig {
 public:
  struct SensorNoise {
    double displacement_noise_m = 0.0;  // [m] standard deviation, not negative
    double force_noise_n = 0.0;         // [N] standard deviation, not negative
    std::uint64_t seed = 0;
    std::uint64_t first_stream = 0;  // two streams per actuator from here on: displacement, force
  };

  /// @param transfer_systems   one per actuator, as many as the specimen has dofs; none null.
  /// @param specimen           not null.
  /// @param control_period     from one exchange() to the next; positive.
  /// @throws ConfigError for values outside these ranges.
  SimulatedRig(std::vector<std::unique_ptr<TransferSystem>> transfer_systems, std::unique_ptr<Specimen> specimen,
               const SensorNoise& noise, Duration control_period);

  void connect() override;
  /// @throws std::runtime_error without a connect() before, or when stopped since then.
  void arm() override;
  [[nodiscard]] RigStatus exchange(const ActuatorCommand& command, RigFeedback& feedback) noexcept override;
  void stop_motion() noexcept override;

 private:
  enum class Phase : std::uint8_t { disconnected, connected, armed, stopped };

  /// An actuator's transducers.
  struct Sensors {
    NoisySensor displacement;
    NoisySensor force;
  };

  [[nodiscard]] bool is_usable(const InterfaceVector& command_m) const noexcept;
  void move(const InterfaceVector& command_m) noexcept;

  std::vector<std::unique_ptr<TransferSystem>> transfer_systems_;
  std::unique_ptr<Specimen> specimen_;
  std::vector<Sensors> sensors_;
  double control_period_s_;
  std::atomic<Phase> phase_{Phase::disconnected};  // the only member that stop_motion() touches
  InterfaceVector displacement_m_;
  InterfaceVector previous_displacement_m_;
  InterfaceVector velocity_m_per_s_;
  InterfaceVector force_n_;
};

}  // namespace hybridtest
