#include "launch/run_monitor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <utility>

#include "runtime/executor.hpp"

namespace hybridtest {
namespace {

constexpr Duration kPoll = std::chrono::milliseconds{50};
constexpr Duration kGrace = std::chrono::seconds{3};
/// For the processes of a test in which nothing has moved.
constexpr Duration kGraceUnarmed = std::chrono::milliseconds{700};
/// For the sites to come to rest by themselves when the coordinator has left in order.
constexpr Duration kAfterCoordinator = std::chrono::milliseconds{300};

}  // namespace

RunMonitor::RunMonitor(const Scenario& scenario, Transport& transport,
                       std::vector<std::unique_ptr<ChildProcess>> children, Progress& progress,
                       std::string resume_command)
    : scenario_{scenario},
      progress_{progress},
      statuses_{transport.status_inbox()},
      events_{transport.event_inbox()},
      signals_{transport.signal_inbox()},
      control_{transport.control_outbox()},
      children_{std::move(children)},
      resume_command_{std::move(resume_command)} {}

Instant RunMonitor::advance(Instant now) noexcept {
  listen(now);
  pass_on_stop(now);
  watch_children(now);
  progress_.show(now);
  return now + kPoll;
}

void RunMonitor::listen(Instant now) {
  ParticipantStatus status;
  while (statuses_->take(status)) {
    progress_.learn(status);
    const bool runs = status.state == LifecycleState::running;
    is_armed_ = is_armed_ || runs || status.state == LifecycleState::armed;
    has_started_ = has_started_ || runs;
    if (status.role != Role::coordinator) continue;
    progress_.set_completed(status.last_step, now);
    learn_coordinator(status, now);
  }
  SignalBlock block;
  while (signals_->take(block)) progress_.learn(block);
  Event event;
  while (events_->take(event)) {
    progress_.print(event);
    if (event.code == EventCode::test_stopped && event.source == ParticipantId{kCoordinatorId}) test_was_ended_ = true;
    if (event.severity == Severity::fault || event.code == EventCode::test_stopped) telling_events_.push_back(event);
  }
}

void RunMonitor::ask_all_to_stop() {
  for (const auto& child : children_) child->send_signal(SIGTERM);
}

void RunMonitor::pass_on_stop(Instant now) {
  if (!stop_was_requested() || stop_was_asked_) return;
  stop_was_asked_ = true;
  if (is_armed_) {
    // The coordinator stops all participants; without a coordinator each stops by itself.
    if (is_awaited_) {
      ask_all_to_stop();
    } else if (!children_.empty()) {
      children_.front()->send_signal(SIGTERM);
    }
    return;
  }
  ask_all_to_stop();
  kill_by_ = now + kGraceUnarmed;
}

void RunMonitor::note_ends() {
  for (const auto& child : children_) {
    if (child->is_running()) continue;
    if (std::ranges::find(ends_, child->id(), &ProcessEnd::participant) != ends_.end()) continue;
    ProcessEnd end{.participant = child->id(),
                   .exit_code = *child->exit_code(),
                   .signal = child->signal(),
                   .words = child->last_words(),
                   .was_asked = stop_was_asked_ || test_was_ended_ || !ends_.empty(),
                   .before_start = !has_started_};
    if (const auto host = hosts_.find(child->id()); host != hosts_.end() && end.signal == 0) {
      end.host = host->second;
      end.take_code_of_ssh(end.exit_code);
      // The participant obeys at once, and its stop may arrive here before this end is seen.
      if (end.has_lost_connection()) end.was_asked = stop_was_asked_;
    }
    ends_.push_back(std::move(end));
  }
}

/// Nothing moves yet: the test ends at once, and the coordinator records why.
void RunMonitor::end_unstarted_test(Instant now) {
  TestControl stop;
  stop.verb = ControlVerb::stop;
  stop.reason = StopReason::participant_failed;
  if (!leaves_others_alone_) control_->send(stop);
  if (stop_was_asked_) return;
  stop_was_asked_ = true;
  for (const auto& child : children_) {
    if (child->id() != kCoordinatorId) child->send_signal(SIGTERM);
  }
  stop_by_ = now + kGraceUnarmed;
  kill_by_ = stop_by_ + kGraceUnarmed;
}

void RunMonitor::learn_coordinator(const ParticipantStatus& status, Instant now) {
  const bool is_lost = status.state == LifecycleState::lost;
  const bool has_left = status.state == LifecycleState::finished || status.state == LifecycleState::refused;
  if (!is_awaited_) {
    coordinator_ = status.incarnation;
  } else if (status.incarnation == successor_) {
    successor_has_left_ = has_left;
    if (is_lost) {  // died as well: the others wait again
      coordinator_ = std::exchange(successor_, 0);
      resume_by_ = resume_limit(now);
    }
  } else if (status.incarnation != coordinator_ && !is_lost && !has_left) {
    successor_ = status.incarnation;
    was_succeeded_ = true;
  }
}

/// The others notice the loss within the lease, wait, and end by themselves when nobody comes.
Instant RunMonitor::resume_limit(Instant now) const {
  return now + scenario_.timeouts.liveliness_lease + scenario_.timeouts.resume + scenario_.timeouts.stop + kGrace;
}

bool RunMonitor::awaits_successor(Instant now) {
  if (scenario_.timeouts.resume <= Duration::zero() || !has_started_ || stop_was_asked_) return false;
  if (!is_awaited_) {
    const auto end = std::ranges::find(ends_, kCoordinatorId, &ProcessEnd::participant);
    if (end == ends_.end() || end->signal == 0 || test_was_ended_) return false;
    is_awaited_ = true;
    others_wait_elsewhere_ = ends_.size() == children_.size();
    resume_by_ = resume_limit(now);
    stop_by_ = kill_by_ = kNever;
    progress_.clear_line();
    fmt::print(
        stderr,
        "the coordinator has died. The others hold what they have, for up to {:.6g} s. To go on, type in another "
        "terminal:\n  {}\n{}\n",
        to_seconds(scenario_.timeouts.resume), resume_command_,
        others_wait_elsewhere_ ? "`hybridtest stop` ends the test safely" : "Ctrl-C here ends the test safely");
  }
  if (successor_ != 0) return !successor_has_left_;
  return now < resume_by_;
}

void RunMonitor::watch_children(Instant now) {
  note_ends();
  const bool awaits = awaits_successor(now);
  if (ends_.size() == children_.size()) {
    is_done_ = true;
    return;
  }
  if (awaits) return;
  if (!ends_.empty() && !is_armed_ && ends_.front().is_cause()) end_unstarted_test(now);
  if (!ends_.empty() && stop_by_ == kNever && kill_by_ == kNever) {
    // The others notice a loss within the lease and come to rest within the stop timeout.
    const Duration rest = scenario_.timeouts.liveliness_lease + scenario_.timeouts.stop + kGrace;
    const bool coordinator_left_in_order = ends_.front().participant == kCoordinatorId && ends_.front().signal == 0;
    stop_by_ = now + (coordinator_left_in_order ? kAfterCoordinator : rest);
    kill_by_ = now + rest + scenario_.timeouts.stop + kGrace;
  }
  if (now >= stop_by_) {
    ask_all_to_stop();
    stop_by_ = kNever - Duration{1};
  }
  if (now >= kill_by_) {
    for (const auto& child : children_) child->send_signal(SIGKILL);
  }
}

}  // namespace hybridtest
