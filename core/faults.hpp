#pragma once

#include <cstdint>
#include <string_view>

namespace hybridtest {

/// Bit set operators for the flag enums below.
#define HYBRIDTEST_FLAG_OPERATORS(Flags)                                                      \
  [[nodiscard]] constexpr Flags operator|(Flags a, Flags b) noexcept {                        \
    return static_cast<Flags>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b)); \
  }                                                                                           \
  [[nodiscard]] constexpr Flags operator&(Flags a, Flags b) noexcept {                        \
    return static_cast<Flags>(static_cast<std::uint32_t>(a) & static_cast<std::uint32_t>(b)); \
  }                                                                                           \
  constexpr Flags& operator|=(Flags& a, Flags b) noexcept { return a = a | b; }               \
  [[nodiscard]] constexpr bool any(Flags flags) noexcept { return static_cast<std::uint32_t>(flags) != 0; }

/// The faults of a participant, latched until it leaves.
enum class FaultFlags : std::uint32_t {
  none = 0,
  displacement_limit = 1U << 0U,
  velocity_limit = 1U << 1U,
  force_limit = 1U << 2U,
  tracking_error = 1U << 3U,
  command_age = 1U << 4U,   // no command for too long
  energy_error = 1U << 5U,  // hybrid simulation error monitor
  not_finite = 1U << 6U,    // NaN or infinity in a command or a measurement
  rig_fault = 1U << 7U,
  records_dropped = 1U << 8U,   // the recording has holes
  recording_failed = 1U << 9U,  // disk full or file error
  coordinator_lost = 1U << 10U,
  emergency_stop = 1U << 11U,
  participant_lost = 1U << 12U,
  displacement_step = 1U << 13U,   // change between two samples: a broken sensor
  force_step = 1U << 14U,          // likewise
  stuck_sensor = 1U << 15U,        // reads the same while the command moves
  tracking_indicator = 1U << 16U,  // the specimen lags or leads too far
  model_failed = 1U << 17U,        // of a numerical substructure
  resume_refused = 1U << 18U,      // a resumed coordinator asked for another motion than was imposed
};
HYBRIDTEST_FLAG_OPERATORS(FaultFlags)

/// Properties of a measurement.
enum class MeasurementFlags : std::uint32_t {
  none = 0,
  extrapolated = 1U << 0U,  // the target was not yet known when the motion started
  held = 1U << 1U,          // the actuator waited at the last target
  saturated = 1U << 2U,     // a limit clipped the command
  late = 1U << 3U,          // the target came after its own time
  repeated = 1U << 4U,      // stored answer to a repeated command
  // Of a real-time test:
  bridged = 1U << 5U,  // not measured: it had not come by its deadline, and the coordinator put a force in its place
  missed = 1U << 6U,   // measured without the target, which had not come by its time
};
HYBRIDTEST_FLAG_OPERATORS(MeasurementFlags)

/// Why a test ended.
enum class StopReason : std::uint8_t {
  none,
  completed,
  interrupted,       // Ctrl-C or a stop command
  interlock,         // a limit or a fault of a site
  participant_lost,  // no longer heard of, or does not answer
  coordinator_lost,
  not_finite,     // NaN or infinity in the integrator
  not_assembled,  // a participant did not appear or did not arm
  refused,        // scenario digest or identity
  recording_failed,
  emergency_stop,
  participant_failed,  // a participant could not start
  no_equilibrium,      // a step that the integrator iterates found none
  opensees_lost,       // that leads: its connection closed, or it asks for nothing
  opensees_iterates,   // that leads: several trials in a step, with a specimen
  model_failed,        // of a numerical substructure
  deadlines_missed,    // real time: too many in a row
  network_too_slow,    // real time: the round trip does not fit into a step
  resume_refused,      // a resumed coordinator asked for another motion than was imposed
};

enum class EventCode : std::uint16_t {
  none,
  participant_joined,
  participant_ready,
  participant_lost,     // subject: who
  participant_missing,  // subject: who
  digest_mismatch,      // subject: the coordinator's or participant's id
  duplicate_id,         // subject: the id
  second_coordinator,
  test_armed,
  test_started,
  test_completed,
  test_stopped,       // subject: who ended it; values[0]: StopReason
  interlock_tripped,  // subject: the FaultFlags' name; values: observed, limit
  command_overdue,    // values: age [s], limit [s]
  coordinator_lost,
  command_repeated,  // values[0]: attempt
  measurement_not_finite,
  recording_failed,  // values[0]: errno of the file, 0 when it is not known
  records_dropped,   // values[0]: count
  test_paused,
  test_resumed,
  emergency_stop,
  interlock_warned,   // subject and values as interlock_tripped; the test goes on
  interlock_cleared,  // all that can clear have cleared
  zero_offset,        // subject: interface degree of freedom; values: displacement [m], force [N]
  real_time_granted,  // subject: which request; values[0]: priority or cpu
  real_time_refused,  // subject: which request; values: errno, requested value
  answer_overdue,     // subject: who; values[0]: time since the command was sent [s]
  test_stalled,       // subject: who answered last; values: time without a new step [s], wall time of a step [s]
  link_silent,        // subject: who; values: silent for [s], waited for [s]
  link_back,          // subject: who; values[0]: was silent for [s]
  no_equilibrium,     // values: trials, last correction [m]
  opensees_missing,   // that leads; subject: the substructure whose element has not connected
  opensees_refused,   // a client of an element; subject: the substructure; values[0]: ClientFault; values[1]: see
                      // describe()
  opensees_lost,      // subject: the substructure of the element; values as of opensees_refused
  opensees_silent,    // values[0]: time without a question [s]
  opensees_iterates,  // subject: the substructure that was to move again
  model_failed,       // subject: the substructure; values: ModelFault, its value
  // Real time:
  round_trip_rehearsed,  // subject: the substructure; values: 99th percentile [s], what a step has for it [s]
  network_too_slow,      // likewise
  answers_bridged,       // subject: the substructure; values: in a row, in the test so far
  deadlines_missed,      // subject: the substructure; values: in a row, allowed in a row
  pause_refused,
  // Of a test whose coordinator died:
  coordinator_awaited,    // values[0]: at most [s]
  coordinator_succeeded,  // values[0]: waited [s]
  test_continued,         // by the coordinator; values: steps of the recording, time without a coordinator [s]
  imposed_differently,    // subject: the substructure; values: imposed, commanded now [m]
  answer_forgotten,       // subject: the substructure; values: oldest step that it remembers, step commanded
  resume_refused,         // subject: who cannot join a test that is resumed
};

[[nodiscard]] std::string_view name(FaultFlags single_flag) noexcept;
[[nodiscard]] std::string_view name(StopReason reason) noexcept;
[[nodiscard]] std::string_view name(EventCode code) noexcept;

}  // namespace hybridtest
