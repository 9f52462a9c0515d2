#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "transport/bounded_queue.hpp"
#include "transport/fast_dds/matches.hpp"
#include "transport/fast_dds/participant.hpp"
#include "transport/fast_dds/peers.hpp"
#include "transport/fast_dds/wire_mapping.hpp"
#include "transport/transport.hpp"

namespace hybridtest::fast_dds {

/// One DDS writer as an Outbox. send() serialises and hands the packet to the socket in the
/// calling thread.
template <class Message>
class DdsOutbox final : public Outbox<Message>, private dds::DataWriterListener {
 public:
  /// @param matches   receives the listening participants; may be null.
  DdsOutbox(Participant& participant, const Partitions& partitions, std::shared_ptr<Matches> matches = nullptr)
      : participant_{participant}, matches_{std::move(matches)} {
    writer_ = participant_.create_writer<Message>(partitions, this);
  }
  ~DdsOutbox() override {
    participant_.remove(writer_);
    if (matches_) matches_->clear();
  }
  DdsOutbox(const DdsOutbox&) = delete;
  DdsOutbox& operator=(const DdsOutbox&) = delete;

  bool send(const Message& message) noexcept override {
    try {
      encode(message, sample_);
      if (writer_->write(&sample_, dds::HANDLE_NIL) == kReturnOk) return true;
    } catch (...) {  // out of memory inside Fast DDS: treated as a full queue
    }
    participant_.unsent.fetch_add(1, std::memory_order_relaxed);
    return false;
  }

 private:
  void on_publication_matched(dds::DataWriter*, const dds::PublicationMatchedStatus& status) override {
    const GuidPrefix who = prefix_of(status.last_subscription_handle);
    if (!matches_ || who == participant_.prefix()) return;
    matches_->change(who, status.current_count_change);
    participant_.waker.signal();
  }

  Participant& participant_;
  std::shared_ptr<Matches> matches_;
  typename Topic<Message>::Sample sample_;
  dds::DataWriter* writer_ = nullptr;
};

/// One DDS reader as an Inbox. The thread of Fast DDS that receives a sample checks it, converts
/// it, puts it in the queue and wakes the participant's thread; so take() never waits for a lock
/// that is held while the network is served.
///
/// The inbox of statuses adds a status `lost` for every lost participant.
template <class Message>
class DdsInbox final : public Inbox<Message>, private dds::DataReaderListener {
 public:
  /// Several readers can fill one queue, each with the messages of one substructure only.
  struct Intake {
    std::shared_ptr<BoundedQueue<Message>> queue;
    SubstructureIndex substructure = 0;
  };

  /// @param matches   receives the sending participants; may be null.
  DdsInbox(Participant& participant, const Partitions& partitions, std::shared_ptr<Matches> matches = nullptr,
           std::optional<Intake> intake = std::nullopt)
      : participant_{participant},
        own_prefix_{participant.prefix()},
        matches_{std::move(matches)},
        queue_{intake ? intake->queue : std::make_shared<BoundedQueue<Message>>(kInboxCapacity<Message>)} {
    if (intake) only_ = intake->substructure;
    if constexpr (kWatchesPeers) departures_ = participant_.on_departure([this](const auto& who) { lose(who); });
    reader_ = participant_.create_reader<Message>(partitions, this);
  }
  ~DdsInbox() override {
    participant_.remove(reader_);
    if (matches_) matches_->clear();
    if constexpr (kWatchesPeers) participant_.forget(departures_);
  }
  DdsInbox(const DdsInbox&) = delete;
  DdsInbox& operator=(const DdsInbox&) = delete;

  [[nodiscard]] bool take(Message& message) noexcept override { return queue_->pop(message); }

 private:
  static constexpr bool kWatchesPeers = std::is_same_v<Message, ParticipantStatus>;
  struct Nothing {};

  /// What comes with each step stays in the reader until newer samples displace it: Fast DDS allocates for the first
  /// sample of an instance that has none, as it would be for each step.
  [[nodiscard]] bool next(dds::DataReader& reader, dds::SampleInfo& info) {
    if constexpr (Topic<Message>::kDelivery.is_coupling) {
      return reader.read_next_sample(&sample_, &info) == kReturnOk;
    } else {
      return reader.take_next_sample(&sample_, &info) == kReturnOk;
    }
  }

  /// Who may write to a partition is for the permissions to say; what is written there must belong there.
  [[nodiscard]] bool is_expected() const noexcept {
    if constexpr (std::is_same_v<Message, ForceMeasurement>) return !only_ || message_.substructure == *only_;
    return true;
  }

  void on_data_available(dds::DataReader* reader) override {
    dds::SampleInfo info;
    bool any = false;
    {
      const std::lock_guard lock{received_mutex_};
      while (next(*reader, info)) {
        if (!info.valid_data || prefix_of(info.publication_handle) == own_prefix_) continue;
        if (!decode(sample_, message_) || !is_expected()) {
          participant_.malformed.fetch_add(1, std::memory_order_relaxed);
          continue;
        }
        if constexpr (kWatchesPeers) peers_.heard(prefix_of(info.publication_handle), info.instance_handle, message_);
        if (!queue_->push(message_)) participant_.overflowed.fetch_add(1, std::memory_order_relaxed);
        any = true;
      }
    }
    if (any) participant_.waker.signal();
  }

  void on_subscription_matched(dds::DataReader*, const dds::SubscriptionMatchedStatus& status) override {
    const GuidPrefix who = prefix_of(status.last_publication_handle);
    if constexpr (kWatchesPeers) {
      if (status.current_count_change < 0) lose(who);
    }
    if (!matches_ || who == own_prefix_) return;
    matches_->change(who, status.current_count_change);
    participant_.waker.signal();
  }

  void on_requested_deadline_missed(dds::DataReader*, const dds::RequestedDeadlineMissedStatus& status) override {
    if constexpr (kWatchesPeers) {
      miss(peers_.silent(status.last_instance_handle));
    }
  }

  /// A participant whose statuses have stopped.
  void miss(const std::optional<ParticipantStatus>& loss) {
    if (!loss) return;
    participant_.deadlines_missed.fetch_add(1, std::memory_order_relaxed);
    report(*loss);
  }

  void lose(const GuidPrefix& who) {
    if constexpr (kWatchesPeers) {
      if (const std::optional<ParticipantStatus> loss = peers_.gone(who)) report(*loss);
    }
  }

  void report(const ParticipantStatus& loss) {
    if constexpr (kWatchesPeers) {
      queue_->push_displacing(loss);
      participant_.waker.signal();
    }
  }

  Participant& participant_;
  const GuidPrefix own_prefix_;
  std::shared_ptr<Matches> matches_;
  const std::shared_ptr<BoundedQueue<Message>> queue_;
  std::optional<SubstructureIndex> only_;
  std::mutex received_mutex_;  // several threads of Fast DDS may receive
  typename Topic<Message>::Sample sample_;
  Message message_;
  [[no_unique_address]] std::conditional_t<kWatchesPeers, Peers, Nothing> peers_;
  std::size_t departures_ = 0;  // what on_departure() returned
  dds::DataReader* reader_ = nullptr;
};

}  // namespace hybridtest::fast_dds
