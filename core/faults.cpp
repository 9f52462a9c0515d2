#include "core/faults.hpp"

#include "core/exit_code.hpp"

namespace hybridtest {

std::string_view name(FaultFlags single_flag) noexcept {
  switch (single_flag) {
    case FaultFlags::none: return "none";
    case FaultFlags::displacement_limit: return "displacement_limit";
    case FaultFlags::velocity_limit: return "velocity_limit";
    case FaultFlags::force_limit: return "force_limit";
    case FaultFlags::tracking_error: return "tracking_error";
    case FaultFlags::command_age: return "command_age";
    case FaultFlags::energy_error: return "energy_error";
    case FaultFlags::not_finite: return "not_finite";
    case FaultFlags::rig_fault: return "rig_fault";
    case FaultFlags::records_dropped: return "records_dropped";
    case FaultFlags::recording_failed: return "recording_failed";
    case FaultFlags::coordinator_lost: return "coordinator_lost";
    case FaultFlags::emergency_stop: return "emergency_stop";
    case FaultFlags::participant_lost: return "participant_lost";
    case FaultFlags::displacement_step: return "displacement_step";
    case FaultFlags::force_step: return "force_step";
    case FaultFlags::stuck_sensor: return "stuck_sensor";
    case FaultFlags::tracking_indicator: return "tracking_indicator";
    case FaultFlags::model_failed: return "model_failed";
    case FaultFlags::resume_refused: return "resume_refused";
  }
  return "several";
}

std::string_view name(StopReason reason) noexcept {
  const TestEnd& end = test_end(reason);
  return end.reason == reason ? end.name : "unknown";
}

std::string_view name(EventCode code) noexcept {
  switch (code) {
    case EventCode::none: return "none";
    case EventCode::participant_joined: return "participant_joined";
    case EventCode::participant_ready: return "participant_ready";
    case EventCode::participant_lost: return "participant_lost";
    case EventCode::participant_missing: return "participant_missing";
    case EventCode::digest_mismatch: return "digest_mismatch";
    case EventCode::duplicate_id: return "duplicate_id";
    case EventCode::second_coordinator: return "second_coordinator";
    case EventCode::test_armed: return "test_armed";
    case EventCode::test_started: return "test_started";
    case EventCode::test_completed: return "test_completed";
    case EventCode::test_stopped: return "test_stopped";
    case EventCode::interlock_tripped: return "interlock_tripped";
    case EventCode::command_overdue: return "command_overdue";
    case EventCode::coordinator_lost: return "coordinator_lost";
    case EventCode::command_repeated: return "command_repeated";
    case EventCode::measurement_not_finite: return "measurement_not_finite";
    case EventCode::recording_failed: return "recording_failed";
    case EventCode::records_dropped: return "records_dropped";
    case EventCode::test_paused: return "test_paused";
    case EventCode::test_resumed: return "test_resumed";
    case EventCode::emergency_stop: return "emergency_stop";
    case EventCode::interlock_warned: return "interlock_warned";
    case EventCode::interlock_cleared: return "interlock_cleared";
    case EventCode::zero_offset: return "zero_offset";
    case EventCode::real_time_granted: return "real_time_granted";
    case EventCode::real_time_refused: return "real_time_refused";
    case EventCode::answer_overdue: return "answer_overdue";
    case EventCode::test_stalled: return "test_stalled";
    case EventCode::link_silent: return "link_silent";
    case EventCode::link_back: return "link_back";
    case EventCode::no_equilibrium: return "no_equilibrium";
    case EventCode::opensees_missing: return "opensees_missing";
    case EventCode::opensees_refused: return "opensees_refused";
    case EventCode::opensees_lost: return "opensees_lost";
    case EventCode::opensees_silent: return "opensees_silent";
    case EventCode::opensees_iterates: return "opensees_iterates";
    case EventCode::model_failed: return "model_failed";
    case EventCode::round_trip_rehearsed: return "round_trip_rehearsed";
    case EventCode::network_too_slow: return "network_too_slow";
    case EventCode::answers_bridged: return "answers_bridged";
    case EventCode::deadlines_missed: return "deadlines_missed";
    case EventCode::pause_refused: return "pause_refused";
    case EventCode::coordinator_awaited: return "coordinator_awaited";
    case EventCode::coordinator_succeeded: return "coordinator_succeeded";
    case EventCode::test_continued: return "test_continued";
    case EventCode::imposed_differently: return "imposed_differently";
    case EventCode::answer_forgotten: return "answer_forgotten";
    case EventCode::resume_refused: return "resume_refused";
  }
  return "unknown";
}

}  // namespace hybridtest
