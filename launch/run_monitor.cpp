#include "launch/run_monitor.hpp"

#include <algorithm>
#include <csignal>
#include <utility>

#include "runtime/executor.hpp"

namespace hybridtest {
namespace {

constexpr Duration kPoll = std::chrono::milliseconds{50};
constexpr Duration kGrace = std::chrono::seconds{3};

}  // namespace

RunMonitor::RunMonitor(const Scenario& scenario, Transport& transport,
                       std::vector<std::unique_ptr<ChildProcess>> children, Progress& progress)
    : scenario_{scenario},
      progress_{progress},
      statuses_{transport.status_inbox()},
      events_{transport.event_inbox()},
      signals_{transport.signal_inbox()},
      children_{std::move(children)} {}

Instant RunMonitor::advance(Instant now) noexcept {
  listen(now);
  pass_on_stop();
  watch_children(now);
  progress_.show(now);
  return now + kPoll;
}

void RunMonitor::listen(Instant now) {
  ParticipantStatus status;
  while (statuses_->take(status)) {
    progress_.learn(status);
    if (status.role == Role::coordinator) progress_.set_completed(status.last_step, now);
  }
  SignalBlock block;
  while (signals_->take(block)) progress_.learn(block);
  Event event;
  while (events_->take(event)) progress_.print(event);
}

void RunMonitor::pass_on_stop() {
  if (!stop_was_requested() || stop_was_passed_on_) return;
  stop_was_passed_on_ = true;
  // The coordinator stops all participants; without a coordinator each stops by itself.
  if (!children_.empty()) children_.front()->send_signal(SIGTERM);
}

void RunMonitor::watch_children(Instant now) {
  const auto running = std::ranges::count_if(children_, [](const auto& child) { return child->is_running(); });
  if (running == 0) {
    is_done_ = true;
    return;
  }
  const bool someone_left = std::cmp_less(running, children_.size());
  if (someone_left && stop_by_ == kNever) {
    // The others notice the loss within the lease and come to rest within the stop timeout.
    stop_by_ = now + scenario_.timeouts.liveliness_lease + scenario_.timeouts.stop + kGrace;
    kill_by_ = stop_by_ + scenario_.timeouts.stop + kGrace;
    const bool before_the_start = std::ranges::any_of(
        children_, [](const auto& child) { return child->exit_code() == 2 || child->exit_code() == 70; });
    if (before_the_start) stop_by_ = now;
  }
  if (now >= stop_by_) {
    for (const auto& child : children_) child->send_signal(SIGTERM);
    stop_by_ = kNever - Duration{1};
  }
  if (now >= kill_by_) {
    for (const auto& child : children_) child->send_signal(SIGKILL);
  }
}

}  // namespace hybridtest
