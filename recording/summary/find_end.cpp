#include "recording/summary/find_end.hpp"

#include <algorithm>

namespace hybridtest {
namespace {

using Codes = std::vector<EventCode>;

/// The events that tell why a test ended for this reason, the most telling first.
Codes causes_of(StopReason reason) {
  switch (reason) {
    case StopReason::interlock: return {EventCode::interlock_tripped, EventCode::command_overdue};
    case StopReason::participant_lost: return {EventCode::answer_overdue, EventCode::participant_lost};
    case StopReason::coordinator_lost: return {EventCode::coordinator_lost};
    case StopReason::not_finite: return {EventCode::measurement_not_finite};
    case StopReason::no_equilibrium: return {EventCode::no_equilibrium};
    case StopReason::participant_failed: return {EventCode::opensees_lost};
    case StopReason::opensees_lost: return {EventCode::opensees_lost, EventCode::opensees_silent};
    case StopReason::opensees_iterates: return {EventCode::opensees_iterates};
    case StopReason::model_failed: return {EventCode::model_failed};
    case StopReason::deadlines_missed: return {EventCode::deadlines_missed};
    case StopReason::network_too_slow: return {EventCode::network_too_slow};
    case StopReason::resume_refused: return {EventCode::imposed_differently, EventCode::answer_forgotten};
    case StopReason::not_assembled:
      return {EventCode::participant_missing, EventCode::opensees_refused, EventCode::opensees_missing};
    case StopReason::refused:
      return {EventCode::digest_mismatch, EventCode::second_coordinator, EventCode::duplicate_id};
    case StopReason::recording_failed: return {EventCode::recording_failed, EventCode::records_dropped};
    case StopReason::none:
    case StopReason::completed:
    case StopReason::interrupted:
    case StopReason::emergency_stop: return {};
  }
  return {};
}

/// The first event of a code that concerns `who`, or the first of the code if none does.
const RecordedEvent* find(const std::vector<RecordedEvent>& events, EventCode code, const std::string& who) {
  const RecordedEvent* first = nullptr;
  for (const RecordedEvent& recorded : events) {
    if (recorded.event.code != code) continue;
    if (recorded.event.source == ParticipantId{who} || recorded.event.subject == ParticipantId{who}) return &recorded;
    if (first == nullptr) first = &recorded;
  }
  return first;
}

const RecordedEvent* find_stop(const std::vector<RecordedEvent>& events) {
  const auto stop = std::ranges::find_if(events, [](const RecordedEvent& recorded) {
    return recorded.event.code == EventCode::test_stopped && recorded.event.source == ParticipantId{kCoordinatorId};
  });
  return stop == events.end() ? nullptr : &*stop;
}

/// Of a site.
bool is_emergency_stop(const RecordedEvent& recorded) {
  return recorded.event.code == EventCode::interlock_tripped &&
         recorded.event.subject == ParticipantId{name(FaultFlags::emergency_stop)};
}

/// Whether the end of a process may explain a test that ended for this reason. What the coordinator and the sites
/// decided themselves stays.
bool may_explain(const ProcessEnd& process, StopReason reason, std::string_view who) {
  // The coordinator exits with an error code of its own after any test that did not complete with all data.
  const bool exited_in_order = process.participant == kCoordinatorId && process.signal == 0;
  if (exited_in_order && (reason != StopReason::none || !process.before_start)) return false;
  switch (reason) {
    case StopReason::none:
    case StopReason::participant_failed: return true;
    case StopReason::interrupted:
      // Where the connection ends, the participant is told to stop. It then says that it was interrupted.
      if (process.has_lost_connection()) return who == process.participant || process.before_start;
      [[fallthrough]];
    case StopReason::not_assembled: return process.signal != 0 || process.before_start;
    case StopReason::participant_lost:
    case StopReason::coordinator_lost: return process.signal != 0 || process.has_lost_connection();
    case StopReason::completed:
    case StopReason::interlock:
    case StopReason::not_finite:
    case StopReason::no_equilibrium:
    case StopReason::opensees_lost:
    case StopReason::opensees_iterates:
    case StopReason::model_failed:
    case StopReason::deadlines_missed:
    case StopReason::network_too_slow:
    case StopReason::resume_refused:
    case StopReason::refused:
    case StopReason::recording_failed:
    case StopReason::emergency_stop: return false;
  }
  return false;
}

/// A process ended the test, and the coordinator could not know.
void blame(const ProcessEnd& process, RunSummary& summary) {
  summary.end.who = process.participant;
  summary.end.why = process.text();
  const bool has_started = summary.completed_steps > 0 || !process.before_start;
  if (!has_started) {
    summary.stop_reason = StopReason::participant_failed;
  } else {
    summary.stop_reason =
        process.participant == kCoordinatorId ? StopReason::coordinator_lost : StopReason::participant_lost;
  }
}

}  // namespace

void find_end(RunSummary& summary, const std::vector<ProcessEnd>& processes, const std::vector<RecordedEvent>& events) {
  EndSummary& end = summary.end;
  if (summary.completed_steps > 0) end.model_time_s = summary.model_time_s;
  if (const RecordedEvent* stop = find_stop(events)) {
    if (summary.stop_reason == StopReason::none) {
      summary.stop_reason = static_cast<StopReason>(static_cast<int>(stop->event.values[0]));
    }
    end.who = stop->event.subject.text();
  }
  if (summary.stop_reason == StopReason::completed) return;
  if (summary.stop_reason == StopReason::none &&
      std::ranges::any_of(events, [](const auto& one) { return one.event.code == EventCode::coordinator_lost; })) {
    summary.stop_reason = StopReason::coordinator_lost;
    end.who = kCoordinatorId;
  }
  // Sites that obeyed an emergency stop leave. A coordinator that did not hear it has only lost them.
  const bool is_lost =
      summary.stop_reason == StopReason::participant_lost || summary.stop_reason == StopReason::coordinator_lost;
  const auto emergency = std::ranges::find_if(events, is_emergency_stop);
  if (is_lost && emergency != events.end()) {
    summary.stop_reason = StopReason::emergency_stop;
    end.who = kOperatorId;
    end.why = emergency->text;
  }
  for (const EventCode code : causes_of(summary.stop_reason)) {
    const RecordedEvent* cause = find(events, code, end.who);
    if (cause == nullptr) continue;
    end.why = cause->text;
    if (end.who.empty()) end.who = cause->event.source.text();
    if (cause->event.step != kNoStep) end.model_time_s = cause->event.model_time_s;
    break;
  }
  // A process that was killed, or that failed before the start, tells more than the events that followed.
  const auto failed = std::ranges::find_if(processes, [&](const ProcessEnd& process) {
    return process.is_cause() && may_explain(process, summary.stop_reason, end.who);
  });
  if (failed != processes.end()) blame(*failed, summary);
  if (summary.stop_reason == StopReason::none && summary.completed_steps == 0 && !processes.empty()) {
    // All were asked to stop before they could record anything.
    summary.stop_reason = StopReason::interrupted;
    end.who = kOperatorId;
  }
}

}  // namespace hybridtest
