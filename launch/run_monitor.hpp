#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/node.hpp"
#include "launch/child_process.hpp"
#include "launch/progress.hpp"
#include "scenario/scenario.hpp"
#include "transport/transport.hpp"

namespace hybridtest {

/// Monitors the processes that `hybridtest run` has started: shows their statuses and events, forwards
/// Ctrl-C as a safe stop, and makes sure that all of them end. It only listens; it is not a participant.
class RunMonitor final : public Node {
 public:
  /// @param children   the coordinator first, if it runs on this machine.
  RunMonitor(const Scenario& scenario, Transport& transport, std::vector<std::unique_ptr<ChildProcess>> children,
             Progress& progress);

  [[nodiscard]] Instant advance(Instant now) noexcept override;
  [[nodiscard]] bool is_done() const noexcept { return is_done_; }
  [[nodiscard]] const std::vector<std::unique_ptr<ChildProcess>>& children() const noexcept { return children_; }

 private:
  void listen(Instant now);
  void pass_on_stop();
  void watch_children(Instant now);

  const Scenario& scenario_;
  Progress& progress_;
  std::unique_ptr<Inbox<ParticipantStatus>> statuses_;
  std::unique_ptr<Inbox<Event>> events_;
  std::unique_ptr<Inbox<SignalBlock>> signals_;
  std::vector<std::unique_ptr<ChildProcess>> children_;
  Instant stop_by_ = kNever;  // then running children receive SIGTERM
  Instant kill_by_ = kNever;  // then SIGKILL
  bool stop_was_passed_on_ = false;
  bool is_done_ = false;
};

}  // namespace hybridtest
