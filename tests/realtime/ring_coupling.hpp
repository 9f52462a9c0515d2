#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <vector>

#include "coordinator/coordinator.hpp"
#include "core/presence.hpp"
#include "core/ring_port.hpp"
#include "experimental_site/control_loop.hpp"
#include "experimental_site/rigs/simulated_rig.hpp"
#include "experimental_site/site_link.hpp"
#include "numerical_substructure/numerical_node.hpp"
#include "recording/row_ring.hpp"

namespace hybridtest {

inline constexpr Duration kControlPeriod = std::chrono::microseconds{500};

/// Sends one message to each of several queues.
template <class Message, std::size_t count>
class Broadcast final : public Outbox<Message> {
 public:
  explicit Broadcast(std::array<RingPort<Message>*, count> ports) noexcept : ports_{ports} {}
  bool send(const Message& message) noexcept override {
    bool accepted = true;
    for (RingPort<Message>* port : ports_) accepted = port->send(message) && accepted;
    return accepted;
  }

 private:
  std::array<RingPort<Message>*, count> ports_;
};

/// Sends a command to the queue of its substructure.
class CommandSwitch final : public Outbox<DisplacementCommand> {
 public:
  explicit CommandSwitch(std::array<RingPort<DisplacementCommand>*, 2> ports) noexcept : ports_{ports} {}
  /// From now on every so many-th command is lost; 0: none.
  void lose_every(int commands) noexcept { lose_every_ = commands; }
  bool send(const DisplacementCommand& command) noexcept override {
    if (lose_every_ > 0 && ++sent_ % lose_every_ == 0) return true;
    return ports_[command.substructure]->send(command);
  }

 private:
  std::array<RingPort<DisplacementCommand>*, 2> ports_;
  int lose_every_ = 0;
  int sent_ = 0;
};

/// A coordinator, a numerical substructure and a site with a simulated rig, coupled by lock-free
/// queues on one thread: the whole product but its transport and its recorder's thread.
class RingCoupling {
 public:
  static constexpr double kStep_s = 0.001;

  RingCoupling(CouplingMode mode, Step last_step, bool compensates, double command_age_s = 1.0);

  /// All participants run once, `passed` later.
  void advance(Duration passed) noexcept;
  /// For a control loop on a thread of its own: everyone else runs once, or the site's link alone,
  /// as when the network hangs.
  void advance_all_but_loop(Instant now) noexcept;
  void advance_link(Instant now) noexcept { static_cast<void>(link_->advance(now)); }
  [[nodiscard]] Node& control_loop() noexcept { return *loop_; }
  /// Oldest row of the control loop's record that was not taken yet; empty when there is none.
  [[nodiscard]] std::vector<double> take_control_row();
  [[nodiscard]] FaultFlags site_faults() const noexcept { return site_presence_.faults(); }

  void lose_commands(int every) noexcept { commands_.lose_every(every); }
  /// Steps without an answer of a substructure.
  [[nodiscard]] std::size_t bridged() const noexcept { return bridge_record_.size(); }
  [[nodiscard]] CoordinatorReport report() const noexcept { return coordinator_->report(); }
  [[nodiscard]] bool is_done() const noexcept {
    return coordinator_->is_done() && link_->is_done() && numerical_->is_done();
  }
  /// Control periods recorded.
  [[nodiscard]] std::size_t control_rows() const noexcept { return control_record_.size(); }

 private:
  static constexpr std::size_t kRows = 1U << 15U;

  RingPort<ParticipantStatus> coordinator_statuses_{64};
  RingPort<ParticipantStatus> site_statuses_{64};
  RingPort<ParticipantStatus> numerical_statuses_{64};
  Broadcast<ParticipantStatus, 2> from_coordinator_{{&site_statuses_, &numerical_statuses_}};
  Broadcast<ParticipantStatus, 2> from_site_{{&coordinator_statuses_, &numerical_statuses_}};
  Broadcast<ParticipantStatus, 2> from_numerical_{{&coordinator_statuses_, &site_statuses_}};
  RingPort<TestAnnouncement> site_announcements_{4};
  RingPort<TestAnnouncement> numerical_announcements_{4};
  Broadcast<TestAnnouncement, 2> announcements_{{&site_announcements_, &numerical_announcements_}};
  RingPort<TestControl> coordinator_control_{16};
  RingPort<TestControl> site_control_{16};
  RingPort<TestControl> numerical_control_{16};
  Broadcast<TestControl, 2> control_{{&site_control_, &numerical_control_}};
  RingPort<DisplacementCommand> site_commands_{16};
  RingPort<DisplacementCommand> numerical_commands_{16};
  CommandSwitch commands_{{&site_commands_, &numerical_commands_}};
  RingPort<ForceMeasurement> measurements_{64};
  RingPort<Event> events_{256};
  RingPort<LoopRequest> requests_{64};
  RingPort<LoopReport> reports_{64};

  RowRing step_record_;
  RowRing exchange_record_;
  RowRing bridge_record_;
  RowRing numerical_record_;
  RowRing site_record_;
  RowRing control_record_;
  Presence coordinator_presence_;
  Presence site_presence_;
  Presence numerical_presence_;
  std::unique_ptr<SimulatedRig> rig_;
  std::unique_ptr<ControlLoop> loop_;
  std::unique_ptr<SiteLink> link_;
  std::unique_ptr<NumericalNode> numerical_;
  std::unique_ptr<Coordinator> coordinator_;
  Instant now_{};
};

/// A rig with a second-order actuator, a bilinear specimen and noise, connected.
[[nodiscard]] std::unique_ptr<SimulatedRig> noisy_rig(Duration control_period);
[[nodiscard]] SiteCompensation compensation(bool compensates, Duration control_period);
/// Every interlock on, none near.
[[nodiscard]] ControlLoopSettings wide_limits(CouplingMode mode, double command_age_s = 1.0);

}  // namespace hybridtest
