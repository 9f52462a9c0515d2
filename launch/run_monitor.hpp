#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/child_process.hpp"
#include "core/node.hpp"
#include "recording/summary/process_end.hpp"
#include "runtime/progress.hpp"
#include "scenario/scenario.hpp"
#include "transport/transport.hpp"

namespace hybridtest {

/// Monitors the processes that `hybridtest run` has started: shows their statuses and events, forwards
/// Ctrl-C as a safe stop, ends the test when one of them fails before the start, and makes sure that all of
/// them end. It is not a participant.
class RunMonitor final : public Node {
 public:
  /// @param children   the coordinator first, if it runs on this machine.
  RunMonitor(const Scenario& scenario, Transport& transport, std::vector<std::unique_ptr<ChildProcess>> children,
             Progress& progress);

  [[nodiscard]] Instant advance(Instant now) noexcept override;
  [[nodiscard]] bool is_done() const noexcept { return is_done_; }
  [[nodiscard]] const std::vector<std::unique_ptr<ChildProcess>>& children() const noexcept { return children_; }
  /// In the order in which they ended.
  [[nodiscard]] const std::vector<ProcessEnd>& ends() const noexcept { return ends_; }
  /// Those of severity fault, and the end of the test.
  [[nodiscard]] const std::vector<Event>& telling_events() const noexcept { return telling_events_; }

 private:
  void listen(Instant now);
  void pass_on_stop(Instant now);
  void watch_children(Instant now);
  void note_ends();
  void end_unstarted_test(Instant now);
  void ask_all_to_stop();

  const Scenario& scenario_;
  Progress& progress_;
  std::unique_ptr<Inbox<ParticipantStatus>> statuses_;
  std::unique_ptr<Inbox<Event>> events_;
  std::unique_ptr<Inbox<SignalBlock>> signals_;
  std::unique_ptr<Outbox<TestControl>> control_;
  std::vector<std::unique_ptr<ChildProcess>> children_;
  std::vector<ProcessEnd> ends_;
  std::vector<Event> telling_events_;
  Instant stop_by_ = kNever;  // then running children receive SIGTERM
  Instant kill_by_ = kNever;  // then SIGKILL
  bool is_armed_ = false;     // something may have moved
  bool has_started_ = false;
  bool stop_was_asked_ = false;
  bool test_was_ended_ = false;  // by the coordinator, which may leave after the others
  bool is_done_ = false;
};

}  // namespace hybridtest
