#include "launch/run_monitor.hpp"

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
                       std::vector<std::unique_ptr<ChildProcess>> children, Progress& progress)
    : scenario_{scenario},
      progress_{progress},
      statuses_{transport.status_inbox()},
      events_{transport.event_inbox()},
      signals_{transport.signal_inbox()},
      control_{transport.control_outbox()},
      children_{std::move(children)} {}

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
    if (status.role == Role::coordinator) progress_.set_completed(status.last_step, now);
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
    if (!children_.empty()) children_.front()->send_signal(SIGTERM);
    return;
  }
  ask_all_to_stop();
  kill_by_ = now + kGraceUnarmed;
}

void RunMonitor::note_ends() {
  for (const auto& child : children_) {
    if (child->is_running()) continue;
    if (std::ranges::find(ends_, child->id(), &ProcessEnd::participant) != ends_.end()) continue;
    const bool was_asked = stop_was_asked_ || test_was_ended_ || !ends_.empty();
    ends_.push_back({.participant = child->id(),
                     .exit_code = *child->exit_code(),
                     .signal = child->signal(),
                     .words = child->last_words(),
                     .was_asked = was_asked,
                     .before_start = !has_started_});
  }
}

/// Nothing moves yet: the test ends at once, and the coordinator records why.
void RunMonitor::end_unstarted_test(Instant now) {
  TestControl stop;
  stop.verb = ControlVerb::stop;
  stop.reason = StopReason::participant_failed;
  control_->send(stop);
  if (stop_was_asked_) return;
  stop_was_asked_ = true;
  for (const auto& child : children_) {
    if (child->id() != kCoordinatorId) child->send_signal(SIGTERM);
  }
  stop_by_ = now + kGraceUnarmed;
  kill_by_ = stop_by_ + kGraceUnarmed;
}

void RunMonitor::watch_children(Instant now) {
  note_ends();
  if (ends_.size() == children_.size()) {
    is_done_ = true;
    return;
  }
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
