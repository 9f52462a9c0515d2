#pragma once

#include <memory>
#include <vector>

#include "transport/transport.hpp"

namespace hybridtest {

/// A transport for a node with deadlines: commands and measurements are sent at once, everything else by another
/// thread, because a reliable DDS writer allocates memory. Inboxes, and the outbox of live signals, are those of the
/// network.
class DeferringTransport final : public Transport {
 public:
  /// @param network   outlives this and its ports.
  explicit DeferringTransport(Transport& network) noexcept : network_{network} {}
  ~DeferringTransport() override;

  /// Sends what waits; by one thread, often. Per sender and kind of message the order is kept.
  void send_waiting() noexcept;

  [[nodiscard]] Waker& waker() noexcept override { return network_.waker(); }
  [[nodiscard]] std::unique_ptr<Outbox<TestAnnouncement>> announcement_outbox() override;
  [[nodiscard]] std::unique_ptr<Inbox<TestAnnouncement>> announcement_inbox() override {
    return network_.announcement_inbox();
  }
  [[nodiscard]] std::unique_ptr<Outbox<ParticipantStatus>> status_outbox() override;
  [[nodiscard]] std::unique_ptr<Inbox<ParticipantStatus>> status_inbox() override { return network_.status_inbox(); }
  [[nodiscard]] std::unique_ptr<Outbox<DisplacementCommand>> command_outbox(std::uint16_t substructure_count) override {
    return network_.command_outbox(substructure_count);
  }
  [[nodiscard]] std::unique_ptr<Inbox<DisplacementCommand>> command_inbox(SubstructureIndex substructure) override {
    return network_.command_inbox(substructure);
  }
  [[nodiscard]] std::unique_ptr<Outbox<ForceMeasurement>> measurement_outbox(SubstructureIndex substructure) override {
    return network_.measurement_outbox(substructure);
  }
  [[nodiscard]] std::unique_ptr<Inbox<ForceMeasurement>> measurement_inbox(std::uint16_t substructure_count) override {
    return network_.measurement_inbox(substructure_count);
  }
  [[nodiscard]] std::unique_ptr<Outbox<TestControl>> control_outbox() override;
  [[nodiscard]] std::unique_ptr<Inbox<TestControl>> control_inbox() override { return network_.control_inbox(); }
  [[nodiscard]] std::unique_ptr<Outbox<Event>> event_outbox() override;
  [[nodiscard]] std::unique_ptr<Inbox<Event>> event_inbox() override { return network_.event_inbox(); }
  [[nodiscard]] std::unique_ptr<Outbox<SignalBlock>> signal_outbox() override { return network_.signal_outbox(); }
  [[nodiscard]] std::unique_ptr<Inbox<SignalBlock>> signal_inbox() override { return network_.signal_inbox(); }
  [[nodiscard]] bool reachable(SubstructureIndex substructure) const noexcept override {
    return network_.reachable(substructure);
  }
  [[nodiscard]] TransportCounters counters() const noexcept override { return network_.counters(); }

 private:
  class Line;
  template <class Message>
  class LineOf;
  template <class Message>
  class DeferredOutbox;

  template <class Message>
  [[nodiscard]] std::unique_ptr<Outbox<Message>> defer(std::unique_ptr<Outbox<Message>> target);

  Transport& network_;
  std::vector<std::shared_ptr<Line>> lines_;
};

}  // namespace hybridtest
