#pragma once

#include <optional>
#include <vector>

#include "core/answer_memory.hpp"
#include "core/membership.hpp"
#include "core/messages.hpp"
#include "core/node.hpp"
#include "core/ports.hpp"
#include "core/presence.hpp"
#include "core/records.hpp"
#include "experimental_site/loop_messages.hpp"

namespace hybridtest {

struct SiteLinkPorts {
  Inbox<DisplacementCommand>& commands;
  Outbox<ForceMeasurement>& measurements;
  Outbox<LoopRequest>& requests;
  Inbox<LoopReport>& reports;
};

/// The network side of a site. It passes each target once and in order to the control loop, and the measurements and
/// faults of the loop back to the coordinator.
///
/// In real time it passes every new target on, also behind a gap, and keeps the control periods in step with the clock
/// of the coordinator: the smallest of `receive_time - send_time` in a window of time is the difference of the clocks
/// plus the shortest latency, and its change since the first window is the drift.
///
/// A coordinator that was resumed from its recording may command steps again that were imposed. They are answered from
/// memory, and nothing moves; where it commands another displacement than was imposed, the link ends the test.
class SiteLink final : public Node {
 public:
  /// @param remembered   answers that are kept for a coordinator that is resumed.
  SiteLink(SubstructureIndex index, int dofs, CouplingMode mode, Presence& presence, MembershipPorts membership,
           SiteLinkPorts ports, RowSink& steps, std::size_t remembered = 0);

  /// Both halves, for a link whose loop has its own thread.
  [[nodiscard]] Instant advance(Instant now) noexcept override;
  /// First half: from the network to the loop.
  void take_messages(Instant now) noexcept;
  /// Second half: from the loop to the network. @return when the link next wants to run.
  [[nodiscard]] Instant pass_reports_on(Instant now) noexcept;

  /// Ends the test safely from the site, as Ctrl-C does, at the next advance().
  void request_stop(StopReason reason) noexcept { requested_stop_ = reason; }

  [[nodiscard]] bool is_done() const noexcept;
  [[nodiscard]] StopReason stop_reason() const noexcept {
    // A link that was refused has not started a stop.
    return stop_reason_ != StopReason::none ? stop_reason_ : membership_.stop_reason();
  }

  [[nodiscard]] static TableLayout steps_layout(int dofs);

 private:
  void follow(Request request) noexcept;
  void begin_stop(StopReason reason) noexcept;
  void pass_on(const DisplacementCommand& command, Instant now) noexcept;
  /// A step that was imposed, for a resumed coordinator.
  void answer_again(const CommandPoint& point, Instant now) noexcept;
  /// Ends the test: the resumed coordinator asks for what cannot be.
  void refuse(Recall recall, const CommandPoint& point, Instant now) noexcept;
  void pass_on_in_time(const DisplacementCommand& command) noexcept;
  void follow_clock(const DisplacementCommand& command, Instant now) noexcept;
  /// @return false when it could not.
  bool pass_target_on(const CommandPoint& point) noexcept;
  void handle(const LoopReport& report, Instant now) noexcept;
  void take_measurement(const StepMeasurement& measurement, Instant now) noexcept;
  void answer(Instant now, MeasurementFlags flags) noexcept;
  void send_answer(Instant now, MeasurementFlags flags) noexcept;
  void record_step(const StepMeasurement& measurement) noexcept;

  SubstructureIndex index_;
  int dofs_;
  CouplingMode mode_;
  Presence& presence_;
  Membership membership_;
  SiteLinkPorts ports_;
  RowSink& steps_;
  StopReason requested_stop_ = StopReason::none;
  StopReason stop_reason_ = StopReason::none;
  AnswerMemory memory_;
  Step passed_on_ = kNoStep;      // newest target given to the loop
  Duration command_send_time_{};  // of the newest command, coordinator's clock
  Duration receive_time_{};
  // In real time:
  Instant window_began_ = kNever;
  Duration least_delay_ = Duration::max();  // in the window
  std::optional<Duration> first_delay_;     // least of the first window
  // The ones being taken and sent; kept, so that their memory is used again.
  DisplacementCommand command_;
  LoopRequest target_{loop_request::Target{}};
  LoopReport report_;
  ForceMeasurement answer_;                                   // newest one, also for repeats
  MeasurementFlags measured_flags_ = MeasurementFlags::none;  // of it
  std::vector<double> row_;
};

/// The link and the loop on one thread, in lockstep mode and in a simulated test: the loop runs between
/// the two halves of the link.
class SiteNode final : public Node {
 public:
  SiteNode(SiteLink& link, Node& loop) noexcept : link_{link}, loop_{loop} {}
  [[nodiscard]] Instant advance(Instant now) noexcept override;

 private:
  SiteLink& link_;
  Node& loop_;
};

}  // namespace hybridtest
