#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

#include "core/interface_vector.hpp"
#include "core/records.hpp"
#include "core/rig_fault.hpp"

namespace hybridtest {

/// Command to the actuators at one control sample.
struct ActuatorCommand {
  std::int64_t sample = 0;    // counts control periods since arming
  double time_s = 0.0;        // [s] since arming
  SiteVector displacement_m;  // [m] one per actuator
};

/// Measured values at the same control sample.
struct RigFeedback {
  SiteVector displacement_m;  // [m] as the transducers read
  SiteVector force_n;         // [N] as the load cells read
};

enum class RigStatus : std::uint8_t { healthy, fault };

/// Gives a rig the tables that it records itself.
using RigTables = std::function<RowSink&(std::string_view table)>;

/// A transfer system with its specimen and sensors, real or simulated.
///
/// Life cycle: constructed -> connect() -> arm() -> exchange() once per control period ->
/// stop_motion(). The actuators do not move before arm() and after stop_motion().
class Rig {
 public:
  virtual ~Rig() = default;

  /// Before connect(): the tables to which the rig appends a row in every exchange(), with values besides
  /// its feedback. Their layouts come from the scenario (scenario/catalogue/rigs.hpp); most rigs have none.
  /// @param tables   the sinks outlive the rig.
  virtual void record_to(const RigTables& /*tables*/) {}
  /// May throw; nothing moves.
  virtual void connect() = 0;
  /// May throw; motion possible afterwards.
  virtual void arm() = 0;
  /// Sends the command and returns the newest measurement; bounded time, no allocation.
  /// @param feedback   vectors sized one per actuator by the caller.
  [[nodiscard]] virtual RigStatus exchange(const ActuatorCommand& command, RigFeedback& feedback) noexcept = 0;
  /// Why the last exchange() or arm() failed. The control thread, after such a failure.
  [[nodiscard]] virtual RigFault fault() const noexcept { return RigFault::unknown; }
  /// Any thread, any state, idempotent.
  virtual void stop_motion() noexcept = 0;
};

}  // namespace hybridtest
