#include "transport/fast_dds/fast_dds_transport.hpp"

#include <array>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/config_error.hpp"
#include "transport/fast_dds/ports.hpp"

namespace hybridtest::fast_dds {
namespace {

using SubstructureMatches = std::array<std::shared_ptr<Matches>, kMaxSubstructures>;

/// The part of a test in which those send their statuses whom also the substructures hear. No id begins like this.
constexpr std::string_view kEveryone = "-everyone";
/// The partition of every test, for readers.
constexpr const char* kEveryTest = "*";

std::string checked_name(std::string_view test_name) {
  if (test_name.empty() || test_name.size() > 64 || test_name.find_first_of("*?[]/") != std::string_view::npos) {
    throw ConfigError{"test name '" + std::string{test_name} + "': expected 1 to 64 characters without * ? [ ] /"};
  }
  return std::string{test_name};
}

/// Commands and measurements of one substructure travel in a partition of their own: the others are neither woken by
/// them nor sent them, and permissions can say who may send them.
std::string partition_of(const std::string& test_name, SubstructureIndex substructure) {
  return test_name + "/" + std::to_string(substructure);
}

/// Commands to every substructure, each through a writer of its own.
class CommandOutbox final : public Outbox<DisplacementCommand> {
 public:
  CommandOutbox(Participant& participant, const std::string& test_name, std::uint16_t substructure_count,
                const SubstructureMatches& matches)
      : participant_{participant} {
    for (SubstructureIndex i = 0; i < substructure_count; ++i) {
      outboxes_.push_back(
          std::make_unique<DdsOutbox<DisplacementCommand>>(participant, partition_of(test_name, i), matches[i]));
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

/// Measurements of every substructure, each through a reader of its own, in one queue.
class MeasurementInbox final : public Inbox<ForceMeasurement> {
 public:
  MeasurementInbox(Participant& participant, const std::string& test_name, std::uint16_t substructure_count,
                   const SubstructureMatches& matches)
      : queue_{std::make_shared<BoundedQueue<ForceMeasurement>>(kInboxCapacity<ForceMeasurement>)} {
    for (SubstructureIndex i = 0; i < substructure_count; ++i) {
      readers_.push_back(std::make_unique<Reader>(participant, partition_of(test_name, i), matches[i],
                                                  Reader::Intake{.queue = queue_, .substructure = i}));
    }
  }

  [[nodiscard]] bool take(ForceMeasurement& measurement) noexcept override { return queue_->pop(measurement); }

 private:
  using Reader = DdsInbox<ForceMeasurement>;
  const std::shared_ptr<BoundedQueue<ForceMeasurement>> queue_;
  std::vector<std::unique_ptr<Reader>> readers_;
};

/// @throws std::invalid_argument above kMaxSubstructures.
void require_possible(std::uint16_t substructure_count) {
  if (substructure_count > kMaxSubstructures) throw std::invalid_argument{"a test has at most 32 substructures"};
}

class FastDdsTransport final : public Transport {
 public:
  FastDdsTransport(std::shared_ptr<Participant> participant, std::string test_name, std::string substructure_id)
      : participant_{std::move(participant)},
        test_name_{std::move(test_name)},
        substructure_id_{std::move(substructure_id)} {
    for (auto& matches : command_matches_) matches = std::make_shared<Matches>();
    for (auto& matches : measurement_matches_) matches = std::make_shared<Matches>();
  }

  [[nodiscard]] Waker& waker() noexcept override { return participant_->waker; }

  [[nodiscard]] std::unique_ptr<Outbox<TestAnnouncement>> announcement_outbox() override {
    return outbox<TestAnnouncement>();
  }
  [[nodiscard]] std::unique_ptr<Inbox<TestAnnouncement>> announcement_inbox() override {
    return inbox<TestAnnouncement>();
  }
  [[nodiscard]] std::unique_ptr<Outbox<ParticipantStatus>> status_outbox() override {
    const std::string heard_in = within(substructure_id_.empty() ? kEveryone : std::string_view{substructure_id_});
    return std::make_unique<DdsOutbox<ParticipantStatus>>(*participant_, Partitions{{test_name_, heard_in}});
  }
  [[nodiscard]] std::unique_ptr<Inbox<ParticipantStatus>> status_inbox() override {
    if (substructure_id_.empty()) return inbox<ParticipantStatus>();
    return std::make_unique<DdsInbox<ParticipantStatus>>(*participant_,
                                                         Partitions{{within(kEveryone), within(substructure_id_)}});
  }
  [[nodiscard]] std::unique_ptr<Outbox<DisplacementCommand>> command_outbox(std::uint16_t substructure_count) override {
    require_possible(substructure_count);
    return std::make_unique<CommandOutbox>(*participant_, test_name_, substructure_count, command_matches_);
  }
  [[nodiscard]] std::unique_ptr<Inbox<DisplacementCommand>> command_inbox(SubstructureIndex substructure) override {
    return std::make_unique<DdsInbox<DisplacementCommand>>(*participant_, partition_of(test_name_, substructure),
                                                           matches_of(command_matches_, substructure));
  }
  [[nodiscard]] std::unique_ptr<Outbox<ForceMeasurement>> measurement_outbox(SubstructureIndex substructure) override {
    return std::make_unique<DdsOutbox<ForceMeasurement>>(*participant_, partition_of(test_name_, substructure),
                                                         matches_of(measurement_matches_, substructure));
  }
  [[nodiscard]] std::unique_ptr<Inbox<ForceMeasurement>> measurement_inbox(std::uint16_t substructure_count) override {
    require_possible(substructure_count);
    return std::make_unique<MeasurementInbox>(*participant_, test_name_, substructure_count, measurement_matches_);
  }
  [[nodiscard]] std::unique_ptr<Outbox<TestControl>> control_outbox() override { return outbox<TestControl>(); }
  [[nodiscard]] std::unique_ptr<Inbox<TestControl>> control_inbox() override { return inbox<TestControl>(); }
  [[nodiscard]] std::unique_ptr<Outbox<Event>> event_outbox() override { return outbox<Event>(); }
  [[nodiscard]] std::unique_ptr<Inbox<Event>> event_inbox() override { return inbox<Event>(); }
  [[nodiscard]] std::unique_ptr<Outbox<SignalBlock>> signal_outbox() override { return outbox<SignalBlock>(); }
  [[nodiscard]] std::unique_ptr<Inbox<SignalBlock>> signal_inbox() override { return inbox<SignalBlock>(); }

  [[nodiscard]] bool reachable(SubstructureIndex substructure) const noexcept override {
    return substructure < kMaxSubstructures &&
           command_matches_[substructure]->share_participant(*measurement_matches_[substructure]);
  }

  [[nodiscard]] TransportCounters counters() const noexcept override {
    return {.overflowed = participant_->overflowed,
            .malformed = participant_->malformed,
            .unsent = participant_->unsent,
            .deadlines_missed = participant_->deadlines_missed,
            .refused_harmful = participant_->refused().harmful,
            .refused_in_plain_text = participant_->refused().in_plain_text,
            .refused_announcements = participant_->refused().announcements,
            .refused_departures = participant_->refused().departures};
  }

 private:
  static std::shared_ptr<Matches> matches_of(const SubstructureMatches& all, SubstructureIndex substructure) {
    return substructure < kMaxSubstructures ? all[substructure] : nullptr;
  }
  template <class Message>
  std::unique_ptr<Outbox<Message>> outbox() {
    return std::make_unique<DdsOutbox<Message>>(*participant_, test_name_);
  }
  template <class Message>
  std::unique_ptr<Inbox<Message>> inbox() {
    return std::make_unique<DdsInbox<Message>>(*participant_, test_name_);
  }

  [[nodiscard]] std::string within(std::string_view name) const { return test_name_ + "/" + std::string{name}; }

  // By substructure: who is at the other end, whichever end this one is.
  SubstructureMatches command_matches_;
  SubstructureMatches measurement_matches_;
  std::shared_ptr<Participant> participant_;
  const std::string test_name_;
  const std::string substructure_id_;  // empty where it is none
};

class FastDdsSearch final : public TestSearch {
 public:
  explicit FastDdsSearch(const FastDdsSettings& settings) : participant_{std::make_shared<Participant>(settings)} {}

  [[nodiscard]] Waker& waker() noexcept override { return participant_->waker; }
  [[nodiscard]] std::unique_ptr<Inbox<TestAnnouncement>> announcements() override {
    return std::make_unique<DdsInbox<TestAnnouncement>>(*participant_, std::string{kEveryTest});
  }
  [[nodiscard]] std::unique_ptr<Transport> join(std::string_view test_name) override {
    return std::make_unique<FastDdsTransport>(participant_, checked_name(test_name), "");
  }

 private:
  std::shared_ptr<Participant> participant_;
};

}  // namespace

std::unique_ptr<Transport> make_fast_dds_transport(const FastDdsSettings& settings, std::string_view test_name) {
  const std::string name = checked_name(test_name);
  return std::make_unique<FastDdsTransport>(std::make_shared<Participant>(settings), name, settings.substructure_id);
}

std::unique_ptr<TestSearch> make_test_search(FastDdsSettings settings) {
  settings.is_observer = true;
  settings.reads_best_effort = true;
  return std::make_unique<FastDdsSearch>(settings);
}

}  // namespace hybridtest::fast_dds
