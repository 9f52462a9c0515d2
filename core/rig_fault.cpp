#include "core/rig_fault.hpp"

namespace hybridtest {

std::string_view describe(RigFault fault) noexcept {
  switch (fault) {
    case RigFault::unknown: break;
    case RigFault::not_connected: return "the rig is not connected";
    case RigFault::invalid_command: return "the command has the wrong size or is not a finite number";
    case RigFault::did_not_arm: return "the rig could not be armed; look at its controller";
    case RigFault::no_answer:
      return "the controller has not answered a new command within the watchdog time; check the controller and the "
             "network to it";
    case RigFault::controller_fault: return "the controller reports a fault of its own; look at its display";
    case RigFault::controller_emergency_stop: return "the emergency stop of the controller is pressed";
    case RigFault::controller_watchdog:
      return "the watchdog of the controller expired: it received no new command in time";
    case RigFault::controller_stopped: return "the controller left the state 'active' by itself";
    case RigFault::end_of_recording: return "the recording that the rig replays is over (`at_end: fault`)";
    case RigFault::stroke_limit: return "a command is beyond the stroke limit of an actuator";
    case RigFault::no_pose: return "no position of the specimen fits the measured strokes of the actuators";
    case RigFault::simulation_not_finite: return "the simulated specimen moved to a number that is not finite";
  }
  return "the rig gives no reason";
}

std::string_view describe(SiteSignal signal) noexcept {
  switch (signal) {
    case SiteSignal::unknown: break;
    case SiteSignal::target: return "the target displacement";
    case SiteSignal::command: return "the command of the compensator";
    case SiteSignal::measured_displacement: return "the measured displacement";
    case SiteSignal::measured_force: return "the measured force";
  }
  return "a signal";
}

}  // namespace hybridtest
