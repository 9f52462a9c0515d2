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

/// Watches over the processes that `hybridtest run` has started: shows what they say, passes a
/// Ctrl-C on as a safe stop, and sees to it that all of them end. Itself part of no test; it
/// listens in.
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
  Instant stop_by_ = kNever;  // children that still run are asked to stop
  Instant kill_by_ = kNever;  // and made to
  bool stop_was_passed_on_ = false;
  bool is_done_ = false;
};

}  // namespace hybridtest
