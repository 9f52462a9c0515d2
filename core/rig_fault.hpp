#pragma once

#include <cstdint>
#include <string_view>

namespace hybridtest {

/// Why a rig reports a fault. Sent as a number: new reasons go to the end.
enum class RigFault : std::uint8_t {
  unknown,
  not_connected,
  invalid_command,
  did_not_arm,
  no_answer,                  // of a controller, for the watchdog time
  controller_fault,           // its own state
  controller_emergency_stop,  // likewise
  controller_watchdog,        // likewise
  controller_stopped,         // left the state `active` by itself
  end_of_recording,
  stroke_limit,
  no_pose,               // no pose of the specimen has the measured strokes
  simulation_not_finite  // the simulated specimen
};

/// Which of a site's signals is not a finite number. Sent as a number: new ones go to the end.
enum class SiteSignal : std::uint8_t { unknown, target, command, measured_displacement, measured_force };

/// For messages, such as "the controller has not answered within the watchdog time".
[[nodiscard]] std::string_view describe(RigFault fault) noexcept;
[[nodiscard]] std::string_view describe(SiteSignal signal) noexcept;

}  // namespace hybridtest
