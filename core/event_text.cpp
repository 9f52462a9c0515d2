#include "core/event_text.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <system_error>

#include "core/client_fault.hpp"
#include "core/model_fault.hpp"
#include "core/rig_fault.hpp"

namespace hybridtest {
namespace {

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

/// Unit of the values of an interlock, by the name of its fault.
std::string_view unit_of(std::string_view fault) {
  if (fault == "displacement_limit" || fault == "tracking_error" || fault == "displacement_step") return " m";
  if (fault == "velocity_limit") return " m/s";
  if (fault == "force_limit" || fault == "force_step") return " N";
  if (fault == "command_age") return " s";
  if (fault == "stuck_sensor") return " samples";
  return "";
}

std::string interlock_text(const Event& event) {
  return "interlock: " + interlock_cause(event.subject.view(), event.values);
}

/// A number that came over the network.
template <class Enumeration>
Enumeration code_of(double value) noexcept {
  return value >= 0.0 && value < 256.0 ? static_cast<Enumeration>(static_cast<std::uint8_t>(value)) : Enumeration{};
}

/// Of an errno; empty when it is not known.
std::string error_text(double number) {
  return number > 0.0 ? " (" + std::generic_category().message(static_cast<int>(number)) + ")" : "";
}

std::string granted_text(const Event& event) {
  const auto subject = event.subject.text();
  if (subject == "scheduling") return "SCHED_FIFO at priority " + number(event.values[0]);
  if (subject == "affinity") return "the control loop stays on processor " + number(event.values[0]);
  return "memory is locked";
}

std::string refused_text(const Event& event) {
  const auto subject = event.subject.text();
  const std::string why = ": " + std::generic_category().message(static_cast<int>(event.values[0]));
  if (subject == "scheduling") {
    return "SCHED_FIFO at priority " + number(event.values[1]) + " was refused" + why +
           "; give the user an rtprio limit of at least that in /etc/security/limits.conf, or the program CAP_SYS_NICE";
  }
  if (subject == "affinity") {
    return "processor " + number(event.values[1]) + " was refused" + why + "; choose one that this process may use";
  }
  return "locking memory was refused" + why +
         "; give the user memlock unlimited in /etc/security/limits.conf, or give the program CAP_IPC_LOCK";
}

}  // namespace

bool has_observed_value(std::string_view fault) noexcept {
  return fault != "not_finite" && fault != "rig_fault" && fault != "emergency_stop";
}

std::string interlock_cause(std::string_view fault, const std::array<double, 2>& values) {
  std::string name{fault};
  if (fault == "rig_fault") return name + ": " + std::string{describe(code_of<RigFault>(values[0]))};
  if (fault == "not_finite") {
    const std::string dof = values[1] >= 1.0 ? " of interface degree of freedom " + number(values[1]) : "";
    return name + ": " + std::string{describe(code_of<SiteSignal>(values[0]))} + dof + " is not a finite number";
  }
  if (!has_observed_value(fault)) return name;
  if (fault == "energy_error") {
    const char* const did = values[0] < 0.0 ? "added energy to the structure, as a late actuator does"
                                            : "removed energy from the structure, as an actuator that leads does";
    return name + ": tracking errors " + did + " (" + number(std::abs(values[0])) +
           " of its largest strain energy, limit " + number(values[1]) + ")";
  }
  const std::string unit{unit_of(fault)};
  return name + " (observed " + number(values[0]) + unit + ", limit " + number(values[1]) + unit + ")";
}

std::string describe(const Event& event) {
  const std::string subject = "'" + event.subject.text() + "'";
  switch (event.code) {
    case EventCode::none: return "nothing";
    case EventCode::participant_joined: return subject + " joined";
    case EventCode::participant_ready: return "ready";
    case EventCode::participant_lost:
      return subject + " is lost: no message within the liveliness lease (timeouts.liveliness_lease_s)";
    case EventCode::participant_missing:
      if (event.values[0] >= 1.0) {
        return subject +
               " is ready, but the connection for its commands and measurements was not made in time: run "
               "`hybridtest doctor` on both hosts";
      }
      return subject + " did not appear or did not get ready in time";
    case EventCode::digest_mismatch:
      return "the scenario differs from that of " + subject +
             "; start every participant with the same file and the same --set";
    case EventCode::duplicate_id:
      return "another participant with the id " + subject +
             " is already in this test; give each participant its own id and start each only once";
    case EventCode::second_coordinator:
      return "another coordinator is already running this test; stop it, or use another test name";
    case EventCode::test_armed: return "armed";
    case EventCode::test_started: return "test started";
    case EventCode::test_completed: return "test completed";
    case EventCode::test_stopped:
      return "test stopped: " + std::string{name(static_cast<StopReason>(static_cast<int>(event.values[0])))} +
             (event.subject.text().empty() ? "" : " (" + event.subject.text() + ")");
    case EventCode::interlock_tripped: return interlock_text(event);
    case EventCode::command_overdue:
      return "no command for " + number(event.values[0]) + " s (limit " + number(event.values[1]) +
             " s): holding the last position";
    case EventCode::coordinator_lost: return "the coordinator is lost: bringing the rig to rest";
    case EventCode::command_repeated: return "resent the command to " + subject + ", which has not answered";
    case EventCode::measurement_not_finite: return "received a force that is not a finite number from " + subject;
    case EventCode::recording_failed:
      return "recording failed" + error_text(event.values[0]) +
             ": data are missing from here on; check the free space of the disk";
    case EventCode::records_dropped: return number(event.values[0]) + " rows of the recording were dropped";
    case EventCode::test_paused: return "test paused";
    case EventCode::test_resumed: return "test resumed";
    case EventCode::emergency_stop: return "emergency stop";
    case EventCode::interlock_warned:
      if (event.subject == "command_age") {
        return "no command for " + number(event.values[0]) + " s (limit " + number(event.values[1]) +
               " s): going on when one comes";
      }
      return "warning only, " + interlock_text(event);
    case EventCode::interlock_cleared: return "the interlocks that can clear have cleared";
    case EventCode::zero_offset:
      return "zero offset of " + event.subject.text() + ": " + number(event.values[0]) + " m, " +
             number(event.values[1]) + " N";
    case EventCode::real_time_granted: return "real time: " + granted_text(event);
    case EventCode::real_time_refused: return "real time: " + refused_text(event);
    case EventCode::answer_overdue:
      return subject + " has not answered the command sent " + number(event.values[0]) + " s ago";
    case EventCode::test_stalled:
      return "the test stood still for " + number(event.values[0]) + " s (a step takes " + number(event.values[1]) +
             " s); last to answer: " + subject;
    case EventCode::link_silent:
      return "nothing from " + subject + " for " + number(event.values[0]) + " s: waiting up to " +
             number(event.values[1]) + " s for its link (timeouts.link_s)";
    case EventCode::link_back: return subject + " is back after " + number(event.values[0]) + " s: going on";
    case EventCode::no_equilibrium:
      return "no equilibrium after " + number(event.values[0]) + " trials: the last one was corrected by " +
             number(event.values[1]) +
             " m. A substructure is stiffer or more strongly damped than its initial stiffness says, or yields too far "
             "in a "
             "step: shorten the step, or raise iterations_max or tolerance_m";
    case EventCode::opensees_missing:
      return "OpenSees has not connected its element for " + subject +
             "; look at the port of the element, and at the end of opensees.log";
    case EventCode::opensees_refused:
      return "refused a client at the element of " + subject + ": " +
             describe(code_of<ClientFault>(event.values[0]), event.values[1]);
    case EventCode::opensees_lost:
      if (event.subject == ParticipantId{kOpenSeesId}) {
        return "OpenSees ended before its model had; look at the end of opensees.log";
      }
      return "lost OpenSees at the element of " + subject + ": " +
             describe(code_of<ClientFault>(event.values[0]), event.values[1]);
    case EventCode::opensees_silent:
      return "OpenSees has asked for nothing for " + number(event.values[0]) +
             " s; look whether its process still runs, or give it more time (coordinator.silence_s)";
    case EventCode::opensees_iterates:
      return "OpenSees asked for a second displacement of " + subject +
             " in one step; a specimen cannot go back. Use an analysis that moves once a step, such as Newmark with "
             "Linear, AlphaOS or CentralDifference, or set coordinator.allow_iterations: true where each trial may "
             "be imposed";
    case EventCode::model_failed:
      return "the model of " + subject +
             " failed: " + describe(ModelFailure{code_of<ModelFault>(event.values[0]), event.values[1]}) +
             "; see the end of its output in the run directory";
    case EventCode::round_trip_rehearsed:
      return "round trip to " + subject + ": 99 % within " + number(1e6 * event.values[0]) + " us; a step has " +
             number(1e6 * event.values[1]) + " us for it";
    case EventCode::network_too_slow:
      return "the round trip to " + subject + " takes up to " + number(1e6 * event.values[0]) +
             " us (99 %), or too many answers are lost, and a step has " + number(1e6 * event.values[1]) +
             " us for it: lengthen step_s, shorten bridging.deadline_s, or set bridging.start_anyway: true";
    case EventCode::answers_bridged:
      return number(event.values[0]) + " answers of " + subject + " in a row missed their deadline (" +
             number(event.values[1]) + " so far in the test)";
    case EventCode::deadlines_missed:
      return subject + " missed " + number(event.values[0]) + " deadlines in a row; bridging.most_in_a_row is " +
             number(event.values[1]);
    case EventCode::pause_refused: return "a real-time test cannot pause; stop it instead";
    case EventCode::coordinator_awaited:
      return "the coordinator is lost: holding, and waiting up to " + number(event.values[0]) +
             " s (timeouts.resume_s) for `hybridtest run --resume`";
    case EventCode::coordinator_succeeded:
      return "held for " + number(event.values[0]) + " s; the resumed coordinator is there";
    case EventCode::test_continued:
      return "test resumed from its recording with " + number(event.values[0]) + " steps, after " +
             number(event.values[1]) + " s without a coordinator";
    case EventCode::imposed_differently:
      return "the resumed coordinator asked " + subject + " for " + number(event.values[1]) +
             " m in a step that was imposed with " + number(event.values[0]) +
             " m; a specimen cannot go back: start a new test";
    case EventCode::answer_forgotten:
      return "the resumed coordinator asked " + subject + " for step " + number(event.values[1]) +
             ", and its memory begins with step " + number(event.values[0]) + ": start a new test";
    case EventCode::resume_refused:
      return subject + " was not part of this test, which is resumed, or lost what it had imposed: start a new test";
  }
  return "unknown event";
}

}  // namespace hybridtest
