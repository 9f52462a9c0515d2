#include "core/membership.hpp"

#include <utility>

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
    const bool is_waiting = presence_.state() == LifecycleState::waiting;
    if (message.verb == ControlVerb::emergency_stop) {
      presence_.raise(FaultFlags::emergency_stop);
      stop_reason_ = StopReason::emergency_stop;
      return Request::emergency_stop;
    }
    // Without a coordinator the operator's stop is for this participant, and there is nothing to pause.
    if (from_operator && is_waiting && message.verb == ControlVerb::stop) return stop_for(StopReason::interrupted);
    if (from_operator && !is_waiting && (message.verb == ControlVerb::pause || message.verb == ControlVerb::resume)) {
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

  return watch_coordinator(now);
}

Request Membership::watch_coordinator(Instant now) noexcept {
  const LifecycleState state = presence_.state();
  if (coordinator_ == 0 || state == LifecycleState::stopping) return Request::none;
  if (state == LifecycleState::waiting) return await_successor(now);
  if (judged_ == presence_.changes()) return Request::none;
  const bool is_alive = presence_.is_alive(coordinator_);
  if (!coordinator_was_seen_ || is_alive) {
    coordinator_was_seen_ = is_alive;
    judged_ = presence_.changes();
    return Request::none;
  }
  const Peer* peer = presence_.find(kCoordinatorId);
  const bool has_left = peer != nullptr && peer->status.incarnation == coordinator_ &&
                        peer->status.state != LifecycleState::lost;  // in order: nobody will resume it
  const bool runs = state == LifecycleState::running || (state == LifecycleState::armed && has_successor());
  if (!runs || has_left || ports_.resume_timeout <= Duration::zero()) return give_up(now);
  waits_since_ = now;
  presence_.set_state(LifecycleState::waiting);
  presence_.report(now, Severity::warning, EventCode::coordinator_awaited, {},
                   {to_seconds(ports_.resume_timeout), 0.0});
  return Request::pause;
}

Request Membership::await_successor(Instant now) noexcept {
  if (presence_.is_alive(coordinator_)) {  // was there all the time and only not heard
    presence_.set_state(LifecycleState::running);
    return Request::resume;
  }
  if (successor_ != 0 && presence_.is_alive(successor_)) {
    coordinator_ = std::exchange(successor_, 0);
    presence_.set_state(LifecycleState::armed);
    presence_.report(now, Severity::information, EventCode::coordinator_succeeded, {},
                     {to_seconds(now - waits_since_), 0.0});
    return Request::none;
  }
  return now - waits_since_ >= ports_.resume_timeout ? give_up(now) : Request::none;
}

Request Membership::give_up(Instant now) noexcept {
  presence_.raise(FaultFlags::coordinator_lost);
  presence_.report(now, Severity::fault, EventCode::coordinator_lost);
  return stop_for(StopReason::coordinator_lost);
}

void Membership::look_for_coordinator(Instant now) noexcept {
  while (ports_.announcements.take(announcement_)) {
    const bool is_same_scenario = announcement_.scenario_digest == presence_.identity().scenario_digest;
    if (coordinator_ != 0) {
      const bool is_successor = is_same_scenario && announcement_.succeeds == first_coordinator_;
      if (is_successor && announcement_.coordinator != coordinator_) successor_ = announcement_.coordinator;
      continue;
    }
    if (!is_same_scenario) {
      presence_.report(now, Severity::fault, EventCode::digest_mismatch, "coordinator");
      presence_.set_state(LifecycleState::refused);
      return;
    }
    if (!may_join()) {
      presence_.report(now, Severity::fault, EventCode::resume_refused, presence_.identity().id);
      presence_.set_state(LifecycleState::refused);
      return;
    }
    coordinator_ = announcement_.coordinator;
    first_coordinator_ = announcement_.succeeds != 0 ? announcement_.succeeds : coordinator_;
    presence_.set_state(LifecycleState::ready);
    presence_.report(now, Severity::information, EventCode::participant_ready);
  }
}

/// A resumed test is for those who know what was imposed so far.
bool Membership::may_join() const noexcept { return ports_.is_restored == (announcement_.succeeds != 0); }

Request Membership::stop_for(StopReason reason) noexcept {
  stop_reason_ = reason;
  return Request::stop;
}

}  // namespace hybridtest
