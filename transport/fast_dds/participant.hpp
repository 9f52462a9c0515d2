#pragma once

#include <atomic>
#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "transport/fast_dds/dds_version.hpp"
#include "transport/fast_dds/packet_filter.hpp"
#include "transport/fast_dds/polled_socket.hpp"
#include "transport/fast_dds/topics.hpp"
#include "transport/waker.hpp"

namespace hybridtest::fast_dds {

/// The partitions of an endpoint: it is matched with the endpoints that share one of them.
struct Partitions {
  Partitions(std::string name) : names{std::move(name)} {}
  Partitions(std::vector<std::string> all) : names{std::move(all)} {}
  friend auto operator<=>(const Partitions&, const Partitions&) = default;

  std::vector<std::string> names;
};

/// The DDS entities that the ports of one participant share. Throws std::runtime_error wherever
/// Fast DDS returns nothing.
class Participant final : private dds::DomainParticipantListener {
 public:
  explicit Participant(const FastDdsSettings& settings);
  ~Participant() override;
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  template <class Message>
  [[nodiscard]] dds::DataWriter* create_writer(const Partitions& partitions, dds::DataWriterListener* listener) {
    return create_writer(topic<Message>(), partitions, writer_qos(Topic<Message>::kDelivery, settings_), listener);
  }
  void remove(dds::DataWriter* writer) noexcept;

  template <class Message>
  [[nodiscard]] dds::DataReader* create_reader(const Partitions& partitions, dds::DataReaderListener* listener) {
    return create_reader(topic<Message>(), partitions, reader_qos(Topic<Message>::kDelivery, settings_), listener);
  }
  void remove(dds::DataReader* reader) noexcept;

  [[nodiscard]] GuidPrefix prefix() const { return participant_->guid().guidPrefix; }

  /// The action is called from threads of Fast DDS when another participant left or its lease
  /// ran out, until forget() is called with what this returns.
  [[nodiscard]] std::size_t on_departure(std::function<void(const GuidPrefix&)> action);
  void forget(std::size_t departure_action) noexcept;

 private:
  const std::shared_ptr<PolledSocket> socket_;  // null where a thread of Fast DDS receives
  const std::shared_ptr<RefusedPackets> refused_ = std::make_shared<RefusedPackets>();

 public:
  Waker waker{socket_.get()};
  /// By the packet filter.
  [[nodiscard]] const RefusedPackets& refused() const noexcept { return *refused_; }
  std::atomic<std::uint64_t> overflowed{0};
  std::atomic<std::uint64_t> malformed{0};
  std::atomic<std::uint64_t> unsent{0};
  std::atomic<std::uint64_t> deadlines_missed{0};

 private:
  template <class Message>
  dds::Topic* topic() {
    return topic(Topic<Message>::kName, [this] {
      auto* type = new CheckedType<typename Topic<Message>::Type>{malformed, std::is_same_v<Message, SignalBlock>};
      return dds::TypeSupport{type};  // owns it
    });
  }

  dds::Topic* topic(const char* name, const std::function<dds::TypeSupport()>& make_type);
  dds::DataWriter* create_writer(dds::Topic* topic, const Partitions& partitions, const dds::DataWriterQos& qos,
                                 dds::DataWriterListener* listener);
  dds::DataReader* create_reader(dds::Topic* topic, const Partitions& partitions, const dds::DataReaderQos& qos,
                                 dds::DataReaderListener* listener);
  void on_participant_discovery(dds::DomainParticipant* participant, DiscoveryInfo&& info) override;

  const FastDdsSettings settings_;
  dds::DomainParticipant* participant_ = nullptr;
  std::mutex mutex_;  // guards what follows
  std::map<std::string, dds::Topic*> topics_;
  std::map<Partitions, dds::Publisher*> publishers_;
  std::map<Partitions, dds::Subscriber*> subscribers_;
  std::mutex departure_mutex_;
  std::map<std::size_t, std::function<void(const GuidPrefix&)>> departure_actions_;
  std::size_t departure_count_ = 0;
};

}  // namespace hybridtest::fast_dds
