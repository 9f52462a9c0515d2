#pragma once

#include <map>
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
///
/// A coordinator that dies in a test with `timeouts.resume_s` leaves the others running for that time: the monitor says
/// how to go on, and waits for a successor of it, which another `hybridtest run --resume` starts.
class RunMonitor final : public Node {
 public:
  /// @param children         the coordinator first, if it runs on this machine.
  /// @param resume_command   to be typed when the coordinator has died.
  RunMonitor(const Scenario& scenario, Transport& transport, std::vector<std::unique_ptr<ChildProcess>> children,
             Progress& progress, std::string resume_command = "");

  /// Where a test is resumed: those who wait for it are not stopped when it cannot go on.
  void leave_others_alone() noexcept { leaves_others_alone_ = true; }

  /// These children, by participant, are the ssh to a participant on that host.
  void set_hosts(std::map<std::string, std::string> hosts) { hosts_ = std::move(hosts); }

  [[nodiscard]] Instant advance(Instant now) noexcept override;
  [[nodiscard]] bool is_done() const noexcept { return is_done_; }
  [[nodiscard]] const std::vector<std::unique_ptr<ChildProcess>>& children() const noexcept { return children_; }
  /// The coordinator among the children died, and another one went on with the test.
  [[nodiscard]] bool was_succeeded() const noexcept { return was_succeeded_; }
  /// The coordinator died and no other child was left: who waits for a successor is watched elsewhere.
  [[nodiscard]] bool leaves_a_waiting_test() const noexcept { return others_wait_elsewhere_; }
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
  /// @return whether the coordinator has died and may be resumed, or was.
  [[nodiscard]] bool awaits_successor(Instant now);
  void learn_coordinator(const ParticipantStatus& status, Instant now);
  [[nodiscard]] Instant resume_limit(Instant now) const;

  const Scenario& scenario_;
  Progress& progress_;
  std::unique_ptr<Inbox<ParticipantStatus>> statuses_;
  std::unique_ptr<Inbox<Event>> events_;
  std::unique_ptr<Inbox<SignalBlock>> signals_;
  std::unique_ptr<Outbox<TestControl>> control_;
  std::vector<std::unique_ptr<ChildProcess>> children_;
  std::map<std::string, std::string> hosts_;
  std::vector<ProcessEnd> ends_;
  std::vector<Event> telling_events_;
  Instant stop_by_ = kNever;  // then running children receive SIGTERM
  Instant kill_by_ = kNever;  // then SIGKILL
  std::string resume_command_;
  Incarnation coordinator_ = 0;  // heard last
  Incarnation successor_ = 0;    // of one that died; 0 while there is none
  Instant resume_by_ = kNever;   // then nobody waits for a successor any more
  bool leaves_others_alone_ = false;
  bool is_awaited_ = false;  // the coordinator has died
  bool others_wait_elsewhere_ = false;
  bool was_succeeded_ = false;
  bool successor_has_left_ = false;  // in order
  bool is_armed_ = false;            // something may have moved
  bool has_started_ = false;
  bool stop_was_asked_ = false;
  bool test_was_ended_ = false;  // by the coordinator, which may leave after the others
  bool is_done_ = false;
};

}  // namespace hybridtest
