#include "core/membership.hpp"

namespace hybridtest {

Request Membership::next_request(Instant now) noexcept {
  const LifecycleState state = presence_.state();
  if (state == LifecycleState::finished || state == LifecycleState::refused) return Request::none;
  if (presence_.is_duplicate()) {
    presence_.report(now, Severity::fault, EventCode::duplicate_id, presence_.identity().id);
    presence_.set_state(LifecycleState::refused);
    return stop_for(StopReason::refused);
  }
  look_for_coordinator(now);
  if (presence_.state() == LifecycleState::refused) return stop_for(StopReason::refused);
  if (coordinator_ == 0 && now.time_since_epoch() >= ports_.discovery_timeout) {
    presence_.report(now, Severity::fault, EventCode::participant_missing, "coordinator");
    presence_.set_state(LifecycleState::refused);
    return stop_for(StopReason::not_assembled);
  }

  TestControl message;
  while (ports_.control.take(message)) {
    const bool from_operator = message.sender_role == Role::operator_tool;
    if (message.verb == ControlVerb::emergency_stop) {
      presence_.raise(FaultFlags::emergency_stop);
      stop_reason_ = StopReason::emergency_stop;
      return Request::emergency_stop;
    }
    if (from_operator && (message.verb == ControlVerb::pause || message.verb == ControlVerb::resume)) {
      return message.verb == ControlVerb::pause ? Request::pause : Request::resume;
    }
    if (coordinator_ == 0 || message.sender != coordinator_) continue;
    switch (message.verb) {
      case ControlVerb::arm:
        if (state == LifecycleState::ready) return Request::arm;
        break;
      case ControlVerb::start:
        if (state == LifecycleState::armed) return Request::start;
        break;
      case ControlVerb::stop: return stop_for(message.reason);
      case ControlVerb::pause: return Request::pause;
      case ControlVerb::resume: return Request::resume;
      case ControlVerb::emergency_stop: break;  // obeyed above, whoever sent it
    }
  }

  if (coordinator_ != 0 && state != LifecycleState::stopping) {
    const bool is_alive = presence_.is_alive(coordinator_);
    if (coordinator_was_seen_ && !is_alive) {
      presence_.raise(FaultFlags::coordinator_lost);
      presence_.report(now, Severity::fault, EventCode::coordinator_lost);
      return stop_for(StopReason::coordinator_lost);
    }
    coordinator_was_seen_ = coordinator_was_seen_ || is_alive;
  }
  return Request::none;
}

void Membership::look_for_coordinator(Instant now) noexcept {
  while (ports_.announcements.take(announcement_)) {
    if (coordinator_ != 0) continue;
    if (announcement_.scenario_digest != presence_.identity().scenario_digest) {
      presence_.report(now, Severity::fault, EventCode::digest_mismatch, "coordinator");
      presence_.set_state(LifecycleState::refused);
      return;
    }
    coordinator_ = announcement_.coordinator;
    presence_.set_state(LifecycleState::ready);
    presence_.report(now, Severity::information, EventCode::participant_ready);
  }
}

Request Membership::stop_for(StopReason reason) noexcept {
  stop_reason_ = reason;
  return Request::stop;
}

}  // namespace hybridtest
