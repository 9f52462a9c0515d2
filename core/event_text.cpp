#include "core/event_text.hpp"

#include <array>
#include <cstdio>

namespace hybridtest {
namespace {

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

/// Unit of the values of an interlock, by the name of its fault.
std::string_view unit_of(std::string_view fault) {
  if (fault == "displacement_limit" || fault == "tracking_error") return " m";
  if (fault == "velocity_limit") return " m/s";
  if (fault == "force_limit") return " N";
  if (fault == "command_age") return " s";
  return "";
}

std::string interlock_text(const Event& event) {
  const auto subject = event.subject.text();
  const std::string unit{unit_of(subject)};
  return "interlock: " + subject + " (observed " + number(event.values[0]) + unit + ", limit " +
         number(event.values[1]) + unit + ")";
}

}  // namespace

std::string describe(const Event& event) {
  const std::string subject = "'" + event.subject.text() + "'";
  switch (event.code) {
    case EventCode::none: return "nothing";
    case EventCode::participant_joined: return subject + " joined";
    case EventCode::participant_ready: return "ready";
    case EventCode::participant_lost: return subject + " is lost: nothing heard within the liveliness lease";
    case EventCode::participant_missing: return subject + " did not appear or did not get ready in time";
    case EventCode::digest_mismatch:
      return "the scenario differs from that of " + subject + "; start every participant with the same file";
    case EventCode::duplicate_id: return "another participant with the id " + subject + " is in this test";
    case EventCode::second_coordinator: return "another coordinator is running this test";
    case EventCode::test_armed: return "armed";
    case EventCode::test_started: return "test started";
    case EventCode::test_completed: return "test completed";
    case EventCode::test_stopped:
      return "test stopped: " + std::string{name(static_cast<StopReason>(static_cast<int>(event.values[0])))};
    case EventCode::interlock_tripped: return interlock_text(event);
    case EventCode::command_overdue:
      return "no command for " + number(event.values[0]) + " s (limit " + number(event.values[1]) +
             " s): holding the last position";
    case EventCode::coordinator_lost: return "the coordinator is lost: bringing the rig to rest";
    case EventCode::command_repeated: return "repeated the command to " + subject + ", which has not answered";
    case EventCode::measurement_not_finite: return "a force that is not a finite number came from " + subject;
    case EventCode::recording_failed: return "recording failed: data are missing from here on";
    case EventCode::records_dropped: return number(event.values[0]) + " records could not be kept";
    case EventCode::test_paused: return "test paused";
    case EventCode::test_resumed: return "test resumed";
    case EventCode::emergency_stop: return "emergency stop";
  }
  return "unknown event";
}

}  // namespace hybridtest
