#include "transport/fast_dds/fast_dds_transport.hpp"

#include <array>
#include <stdexcept>
#include <vector>

#include "transport/fast_dds/ports.hpp"

namespace hybridtest::fast_dds {
namespace {

using CommandMatches = std::array<std::shared_ptr<Matches>, kMaxSubstructures>;

/// Commands to every substructure, each through a writer of its own.
class CommandOutbox final : public Outbox<DisplacementCommand> {
 public:
  CommandOutbox(Participant& participant, std::uint16_t substructure_count, const CommandMatches& matches)
      : participant_{participant} {
    for (SubstructureIndex i = 0; i < substructure_count; ++i) {
      outboxes_.push_back(
          std::make_unique<DdsOutbox<DisplacementCommand>>(participant, participant.partition(i), matches[i]));
    }
  }

  bool send(const DisplacementCommand& command) noexcept override {
    if (command.substructure < outboxes_.size()) return outboxes_[command.substructure]->send(command);
    participant_.unsent.fetch_add(1, std::memory_order_relaxed);
    return false;
  }

 private:
  Participant& participant_;
  std::vector<std::unique_ptr<DdsOutbox<DisplacementCommand>>> outboxes_;
};

class FastDdsTransport final : public Transport {
 public:
  FastDdsTransport(const FastDdsSettings& settings, std::string_view test_name) : participant_{settings, test_name} {
    for (auto& matches : command_matches_) matches = std::make_shared<Matches>();
  }

  [[nodiscard]] Waker& waker() noexcept override { return participant_.waker; }

  [[nodiscard]] std::unique_ptr<Outbox<TestAnnouncement>> announcement_outbox() override {
    return outbox<TestAnnouncement>();
  }
  [[nodiscard]] std::unique_ptr<Inbox<TestAnnouncement>> announcement_inbox() override {
    return inbox<TestAnnouncement>();
  }
  [[nodiscard]] std::unique_ptr<Outbox<ParticipantStatus>> status_outbox() override {
    return outbox<ParticipantStatus>();
  }
  [[nodiscard]] std::unique_ptr<Inbox<ParticipantStatus>> status_inbox() override { return inbox<ParticipantStatus>(); }
  [[nodiscard]] std::unique_ptr<Outbox<DisplacementCommand>> command_outbox(std::uint16_t substructure_count) override {
    if (substructure_count > kMaxSubstructures) throw std::invalid_argument{"a test has at most 32 substructures"};
    return std::make_unique<CommandOutbox>(participant_, substructure_count, command_matches_);
  }
  [[nodiscard]] std::unique_ptr<Inbox<DisplacementCommand>> command_inbox(SubstructureIndex substructure) override {
    return std::make_unique<DdsInbox<DisplacementCommand>>(participant_, participant_.partition(substructure));
  }
  [[nodiscard]] std::unique_ptr<Outbox<ForceMeasurement>> measurement_outbox() override {
    return outbox<ForceMeasurement>();
  }
  [[nodiscard]] std::unique_ptr<Inbox<ForceMeasurement>> measurement_inbox() override {
    return std::make_unique<DdsInbox<ForceMeasurement>>(participant_, participant_.partition(), measurement_matches_);
  }
  [[nodiscard]] std::unique_ptr<Outbox<TestControl>> control_outbox() override { return outbox<TestControl>(); }
  [[nodiscard]] std::unique_ptr<Inbox<TestControl>> control_inbox() override { return inbox<TestControl>(); }
  [[nodiscard]] std::unique_ptr<Outbox<Event>> event_outbox() override { return outbox<Event>(); }
  [[nodiscard]] std::unique_ptr<Inbox<Event>> event_inbox() override { return inbox<Event>(); }
  [[nodiscard]] std::unique_ptr<Outbox<SignalBlock>> signal_outbox() override { return outbox<SignalBlock>(); }
  [[nodiscard]] std::unique_ptr<Inbox<SignalBlock>> signal_inbox() override { return inbox<SignalBlock>(); }

  [[nodiscard]] bool reachable(SubstructureIndex substructure) const noexcept override {
    return substructure < kMaxSubstructures && command_matches_[substructure]->share_participant(*measurement_matches_);
  }

  [[nodiscard]] TransportCounters counters() const noexcept override {
    return {.overflowed = participant_.overflowed,
            .malformed = participant_.malformed,
            .unsent = participant_.unsent,
            .deadlines_missed = participant_.deadlines_missed};
  }

 private:
  template <class Message>
  std::unique_ptr<Outbox<Message>> outbox() {
    return std::make_unique<DdsOutbox<Message>>(participant_, participant_.partition());
  }
  template <class Message>
  std::unique_ptr<Inbox<Message>> inbox() {
    return std::make_unique<DdsInbox<Message>>(participant_, participant_.partition());
  }

  CommandMatches command_matches_;
  std::shared_ptr<Matches> measurement_matches_ = std::make_shared<Matches>();
  Participant participant_;
};

}  // namespace

std::unique_ptr<Transport> make_fast_dds_transport(const FastDdsSettings& settings, std::string_view test_name) {
  return std::make_unique<FastDdsTransport>(settings, test_name);
}

}  // namespace hybridtest::fast_dds
