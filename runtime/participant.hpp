#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coordinator/coordinator.hpp"
#include "coordinator/opensees/element_port.hpp"
#include "core/exit_code.hpp"
#include "core/node.hpp"
#include "core/presence.hpp"
#include "core/records.hpp"
#include "core/ring_port.hpp"
#include "experimental_site/control_loop.hpp"
#include "experimental_site/site_link.hpp"
#include "numerical_substructure/numerical_node.hpp"
#include "scenario/scenario.hpp"
#include "transport/transport.hpp"

namespace hybridtest {

/// What a participant needs from its process or from the simulation. Must outlive the participant.
struct ParticipantSurroundings {
  Transport& transport;
  Outbox<Event>& events;
  std::function<RowSink&(std::string_view table)> sink;
  Incarnation incarnation = 0;
  std::filesystem::path run_directory = {};  // empty under simulated time
  bool is_restored = false;                  // see MembershipPorts
};

/// One participant of a test: its node, and the ports of the node.
class Participant {
 public:
  virtual ~Participant() = default;

  [[nodiscard]] virtual Node& node() noexcept = 0;
  [[nodiscard]] virtual bool is_done() const noexcept = 0;
  [[nodiscard]] virtual StopReason stop_reason() const noexcept = 0;
  virtual void request_stop(StopReason reason) noexcept = 0;

  [[nodiscard]] Presence& presence() noexcept { return presence_; }

 protected:
  Participant(const Scenario& scenario, std::string_view id, Role role, const ParticipantSurroundings& surroundings);

  std::unique_ptr<Inbox<ParticipantStatus>> status_in_;
  std::unique_ptr<Outbox<ParticipantStatus>> status_out_;
  std::unique_ptr<Inbox<TestControl>> control_in_;
  Presence presence_;
};

class CoordinatorParticipant final : public Participant {
 public:
  /// Where OpenSees leads, its elements can connect from here on.
  /// @throws ConfigError when a port of them cannot be listened on.
  CoordinatorParticipant(const Scenario& scenario, const ParticipantSurroundings& surroundings);

  [[nodiscard]] Node& node() noexcept override { return *coordinator_; }
  [[nodiscard]] bool is_done() const noexcept override { return coordinator_->is_done(); }
  [[nodiscard]] StopReason stop_reason() const noexcept override { return coordinator_->report().reason; }
  void request_stop(StopReason reason) noexcept override { coordinator_->request_stop(reason); }
  /// See Coordinator::lead_has_left().
  void lead_has_left() noexcept { coordinator_->lead_has_left(); }
  [[nodiscard]] CoordinatorReport report() const noexcept { return coordinator_->report(); }
  /// To restore the state of a recording, before the first advance().
  [[nodiscard]] Coordinator& coordinator() noexcept { return *coordinator_; }

  [[nodiscard]] static std::vector<TableLayout> tables(const Scenario& scenario);

 private:
  std::unique_ptr<Outbox<TestAnnouncement>> announcements_;
  std::unique_ptr<Outbox<TestControl>> control_out_;
  std::unique_ptr<Inbox<ForceMeasurement>> measurements_;
  std::unique_ptr<Outbox<DisplacementCommand>> commands_;
  std::unique_ptr<ElementPort> elements_;  // where OpenSees leads
  std::unique_ptr<Coordinator> coordinator_;
};

class NumericalParticipant final : public Participant {
 public:
  NumericalParticipant(const Scenario& scenario, const SubstructureScenario& substructure,
                       const ParticipantSurroundings& surroundings);

  [[nodiscard]] Node& node() noexcept override { return *numerical_; }
  [[nodiscard]] bool is_done() const noexcept override { return numerical_->is_done(); }
  [[nodiscard]] StopReason stop_reason() const noexcept override { return numerical_->stop_reason(); }
  void request_stop(StopReason reason) noexcept override { numerical_->request_stop(reason); }
  [[nodiscard]] std::string failure_text() const { return numerical_->failure_text(); }
  /// To restore the state of a recording, before the first advance().
  [[nodiscard]] NumericalNode& numerical() noexcept { return *numerical_; }

  [[nodiscard]] static std::vector<TableLayout> tables(const SubstructureScenario& substructure);

 private:
  std::unique_ptr<Inbox<TestAnnouncement>> announcements_;
  std::unique_ptr<Inbox<DisplacementCommand>> commands_;
  std::unique_ptr<Outbox<ForceMeasurement>> measurements_;
  std::unique_ptr<NumericalNode> numerical_;
};

class SiteParticipant final : public Participant {
 public:
  /// Connects the rig. @throws whatever Rig::connect() throws.
  /// @param runs_loop   node() runs the control loop as well; else the loop has its own thread, which
  ///                    polls for requests.
  SiteParticipant(const Scenario& scenario, const SubstructureScenario& substructure,
                  const ParticipantSurroundings& surroundings, bool runs_loop);

  /// The link and the loop, or the link alone.
  [[nodiscard]] Node& node() noexcept override {
    if (node_) return *node_;
    return *link_;
  }
  /// For the thread of the control loop.
  [[nodiscard]] Node& control_loop() noexcept { return *loop_; }
  [[nodiscard]] Rig& rig() noexcept { return *rig_; }
  [[nodiscard]] bool is_done() const noexcept override { return link_->is_done(); }
  [[nodiscard]] StopReason stop_reason() const noexcept override { return link_->stop_reason(); }
  void request_stop(StopReason reason) noexcept override { link_->request_stop(reason); }

  [[nodiscard]] static std::vector<TableLayout> tables(const SubstructureScenario& substructure);

 private:
  /// Sends, and wakes the thread that receives, if there is one.
  template <class Message>
  class WakingOutbox final : public Outbox<Message> {
   public:
    WakingOutbox(Outbox<Message>& target, Waker* waker) noexcept : target_{target}, waker_{waker} {}
    bool send(const Message& message) noexcept override {
      const bool accepted = target_.send(message);
      if (waker_ != nullptr) waker_->signal();
      return accepted;
    }

   private:
    Outbox<Message>& target_;
    Waker* waker_;
  };

  std::unique_ptr<Inbox<TestAnnouncement>> announcements_;
  std::unique_ptr<Inbox<DisplacementCommand>> commands_;
  std::unique_ptr<Outbox<ForceMeasurement>> measurements_;
  RingPort<LoopRequest> requests_;
  RingPort<LoopReport> reports_;
  WakingOutbox<LoopReport> waking_reports_;
  std::unique_ptr<Rig> rig_;
  std::unique_ptr<ControlLoop> loop_;
  std::unique_ptr<SiteLink> link_;
  std::optional<SiteNode> node_;  // none when the loop has its own thread
};

/// The participant of a substructure, numerical or experimental.
[[nodiscard]] std::unique_ptr<Participant> make_substructure_participant(const Scenario& scenario,
                                                                         const SubstructureScenario& substructure,
                                                                         const ParticipantSurroundings& surroundings);
[[nodiscard]] std::vector<TableLayout> substructure_tables(const SubstructureScenario& substructure);

}  // namespace hybridtest
