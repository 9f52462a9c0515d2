#pragma once

#include <memory>
#include <string_view>

#include "transport/transport.hpp"

namespace hybridtest::in_process {

struct HubState;
struct ParticipantState;

/// One participant of a Hub. Its ports stay usable after it has left; they return false.
class InProcessTransport final : public Transport {
 public:
  InProcessTransport(std::shared_ptr<HubState> hub, std::string_view test_name);
  /// Leaves: as kill().
  ~InProcessTransport() override;
  InProcessTransport(const InProcessTransport&) = delete;
  InProcessTransport& operator=(const InProcessTransport&) = delete;

  /// Takes the participant off the hub at once, from any thread: nothing is sent or received
  /// any more, and the others receive `lost`, unless its last status was `finished` or `refused`.
  void kill() noexcept;

  [[nodiscard]] Waker& waker() noexcept override;
  [[nodiscard]] std::unique_ptr<Outbox<TestAnnouncement>> announcement_outbox() override;
  [[nodiscard]] std::unique_ptr<Inbox<TestAnnouncement>> announcement_inbox() override;
  [[nodiscard]] std::unique_ptr<Outbox<ParticipantStatus>> status_outbox() override;
  [[nodiscard]] std::unique_ptr<Inbox<ParticipantStatus>> status_inbox() override;
  [[nodiscard]] std::unique_ptr<Outbox<DisplacementCommand>> command_outbox(std::uint16_t substructure_count) override;
  [[nodiscard]] std::unique_ptr<Inbox<DisplacementCommand>> command_inbox(SubstructureIndex substructure) override;
  [[nodiscard]] std::unique_ptr<Outbox<ForceMeasurement>> measurement_outbox(SubstructureIndex substructure) override;
  [[nodiscard]] std::unique_ptr<Inbox<ForceMeasurement>> measurement_inbox(std::uint16_t substructure_count) override;
  [[nodiscard]] std::unique_ptr<Outbox<TestControl>> control_outbox() override;
  [[nodiscard]] std::unique_ptr<Inbox<TestControl>> control_inbox() override;
  [[nodiscard]] std::unique_ptr<Outbox<Event>> event_outbox() override;
  [[nodiscard]] std::unique_ptr<Inbox<Event>> event_inbox() override;
  [[nodiscard]] std::unique_ptr<Outbox<SignalBlock>> signal_outbox() override;
  [[nodiscard]] std::unique_ptr<Inbox<SignalBlock>> signal_inbox() override;
  [[nodiscard]] bool reachable(SubstructureIndex substructure) const noexcept override;
  [[nodiscard]] TransportCounters counters() const noexcept override;

 private:
  std::shared_ptr<HubState> hub_;
  std::shared_ptr<ParticipantState> participant_;
};

/// The network of one process: participants with the same test name receive each other's messages.
/// Thread-safe. The network lives as long as the hub or any participant or port of it.
class Hub {
 public:
  Hub();

  [[nodiscard]] std::unique_ptr<InProcessTransport> join(std::string_view test_name);

 private:
  std::shared_ptr<HubState> state_;
};

}  // namespace hybridtest::in_process
