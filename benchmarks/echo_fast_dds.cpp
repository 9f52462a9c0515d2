// A plain Fast DDS echo, written as its documentation advises for low latency: fixed-size types,
// preallocated histories, synchronous publishing, and either listeners or wait sets. Uses none of
// our classes, only the same wire types and quality of service (RELIABLE or BEST_EFFORT, KEEP_LAST 16).

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <unistd.h>

#include <bitset>
#include <chrono>
#include <condition_variable>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <mutex>
#include <stdexcept>

#include "benchmarks/echo.hpp"
#include "benchmarks/echo_payload.hpp"
#include "benchmarks/peer_processes.hpp"
#include "hybridtestPubSubTypes.h"

namespace hybridtest::benchmarks {
namespace {

namespace dds = eprosima::fastdds::dds;
using Clock = std::chrono::steady_clock;
using eprosima::fastrtps::types::ReturnCode_t;

constexpr auto kPatience = std::chrono::seconds{20};

template <class Qos>
Qos quality(const EchoSettings& settings) {
  Qos qos;
  qos.reliability().kind = settings.best_effort ? dds::BEST_EFFORT_RELIABILITY_QOS : dds::RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = 16;
  qos.resource_limits().max_instances = settings.peers;
  qos.resource_limits().max_samples_per_instance = 16;
  qos.resource_limits().max_samples = 16 * settings.peers;
  qos.resource_limits().allocated_samples = 16 * settings.peers;
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
  qos.data_sharing().off();
  return qos;
}

dds::DomainParticipantQos participant_quality(const std::string& network) {
  dds::DomainParticipantQos qos;
  if (network == "library_default") return qos;
  const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.emplace_back("127.0.0.1");
  udp->maxInitialPeersRange = 80;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  if (network == "shared_memory") {
    qos.transport().user_transports.push_back(
        std::make_shared<eprosima::fastdds::rtps::SharedMemTransportDescriptor>());
  }
  eprosima::fastrtps::rtps::Locator_t loopback;
  eprosima::fastrtps::rtps::IPLocator::setIPv4(loopback, "127.0.0.1");
  qos.wire_protocol().builtin.metatrafficUnicastLocatorList.push_back(loopback);
  qos.wire_protocol().builtin.initialPeersList.push_back(loopback);
  return qos;
}

/// The entities of both ends: one writer, one reader, one topic in each direction.
class Endpoint {
 public:
  Endpoint(const EchoSettings& settings, int run, bool initiator, dds::DataReaderListener* listener) {
    auto* factory = dds::DomainParticipantFactory::get_instance();
    participant_ = factory->create_participant(settings.domain, participant_quality(settings.network));
    if (participant_ == nullptr) throw std::runtime_error{"Fast DDS could not create a participant"};
    const dds::TypeSupport command{new wire::DisplacementCommandPubSubType};
    const dds::TypeSupport measurement{new wire::ForceMeasurementPubSubType};
    command.register_type(participant_);
    measurement.register_type(participant_);
    auto* commands = participant_->create_topic("echo/command", command.get_type_name(), dds::TOPIC_QOS_DEFAULT);
    auto* measurements =
        participant_->create_topic("echo/measurement", measurement.get_type_name(), dds::TOPIC_QOS_DEFAULT);
    const std::string partition = "echo" + std::to_string(run);
    dds::PublisherQos publisher_qos;
    publisher_qos.partition().push_back(partition.c_str());
    dds::SubscriberQos subscriber_qos;
    subscriber_qos.partition().push_back(partition.c_str());
    auto writer_qos = quality<dds::DataWriterQos>(settings);
    writer_qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
    writer = participant_->create_publisher(publisher_qos)
                 ->create_datawriter(initiator ? commands : measurements, writer_qos);
    reader = participant_->create_subscriber(subscriber_qos)
                 ->create_datareader(initiator ? measurements : commands, quality<dds::DataReaderQos>(settings),
                                     listener, dds::StatusMask::data_available());
    if (writer == nullptr || reader == nullptr)
      throw std::runtime_error{"Fast DDS could not create a writer or reader"};
  }
  ~Endpoint() {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Endpoint(const Endpoint&) = delete;
  Endpoint& operator=(const Endpoint&) = delete;

  [[nodiscard]] bool matched(int peers) const {
    dds::PublicationMatchedStatus publication;
    dds::SubscriptionMatchedStatus subscription;
    writer->get_publication_matched_status(publication);
    reader->get_subscription_matched_status(subscription);
    return publication.current_count == peers && subscription.current_count == peers;
  }

  dds::DataWriter* writer = nullptr;
  dds::DataReader* reader = nullptr;

 private:
  dds::DomainParticipant* participant_ = nullptr;
};

/// Answers every command, in the thread that receives it.
class Answerer : public dds::DataReaderListener {
 public:
  explicit Answerer(int index) { measurement_.substructure(static_cast<std::uint16_t>(index)); }

  void on_data_available(dds::DataReader* reader) override {
    while (reader->take_next_sample(&command_, &info_) == ReturnCode_t::RETCODE_OK) {
      if (!info_.valid_data) continue;
      measurement_.step(command_.points()[0].step());
      writer->write(&measurement_);
    }
  }

  dds::DataWriter* writer = nullptr;

 private:
  wire::DisplacementCommand command_;
  wire::ForceMeasurement measurement_ = echo_measurement_sample();
  dds::SampleInfo info_;
};

/// Who has answered the current step; a command that was sent again is answered again.
class Collector : public dds::DataReaderListener {
 public:
  explicit Collector(int peers) : peers_{static_cast<std::size_t>(peers)} {}

  /// From the callback of Fast DDS.
  void on_data_available(dds::DataReader* reader) override {
    const std::lock_guard lock{mutex_};
    collect(reader);
    if (all_answered()) all_in_.notify_one();
  }

  void expect(std::int64_t step) {
    const std::lock_guard lock{mutex_};
    step_ = step;
    answered_.reset();
  }

  [[nodiscard]] bool wait(std::chrono::milliseconds timeout) {
    std::unique_lock lock{mutex_};
    return all_in_.wait_for(lock, timeout, [&] { return all_answered(); });
  }

  /// From the initiator's own thread.
  [[nodiscard]] bool wait(dds::WaitSet& wait_set, dds::DataReader* reader, std::chrono::milliseconds timeout) {
    const Clock::time_point deadline = Clock::now() + timeout;
    while (true) {
      collect(reader);
      if (all_answered()) return true;
      if (Clock::now() > deadline) return false;
      dds::ConditionSeq active;
      wait_set.wait(active, eprosima::fastrtps::Duration_t{0, 100000000});
    }
  }

 private:
  void collect(dds::DataReader* reader) {
    while (reader->take_next_sample(&measurement_, &info_) == ReturnCode_t::RETCODE_OK) {
      if (info_.valid_data && measurement_.step() == step_) answered_.set(measurement_.substructure());
    }
  }
  [[nodiscard]] bool all_answered() const { return answered_.count() == peers_; }

  std::mutex mutex_;
  std::condition_variable all_in_;
  wire::ForceMeasurement measurement_;
  dds::SampleInfo info_;
  std::int64_t step_ = 0;
  const std::size_t peers_;
  std::bitset<kEchoPeersMax> answered_;
};

}  // namespace

void fast_dds_echo_peer(const EchoSettings& settings, int index, int run) {
  Answerer answerer{index};
  const bool by_listener = settings.wait == "listener";
  Endpoint endpoint{settings, run, false, nullptr};
  answerer.writer = endpoint.writer;
  if (by_listener) {
    endpoint.reader->set_listener(&answerer, dds::StatusMask::data_available());
    while (true) ::pause();
  }
  endpoint.reader->get_statuscondition().set_enabled_statuses(dds::StatusMask::data_available());
  dds::WaitSet wait_set;
  wait_set.attach_condition(endpoint.reader->get_statuscondition());
  while (true) {
    dds::ConditionSeq active;
    wait_set.wait(active, eprosima::fastrtps::c_TimeInfinite);
    answerer.on_data_available(endpoint.reader);
  }
}

std::vector<double> fast_dds_echo_us(const EchoSettings& settings) {
  static int runs = 0;
  const int run = static_cast<int>(::getpid()) * 100 + runs++ % 100;
  PeerProcesses peers;
  for (int i = 0; i < settings.peers; ++i) peers.start(echo_peer_arguments("fast_dds", i, run, settings));
  const bool by_listener = settings.wait == "listener";
  Collector collector{settings.peers};
  Endpoint endpoint{settings, run, true, by_listener ? &collector : nullptr};
  dds::WaitSet wait_set;
  if (!by_listener) {
    endpoint.reader->get_statuscondition().set_enabled_statuses(dds::StatusMask::data_available());
    wait_set.attach_condition(endpoint.reader->get_statuscondition());
  }
  const Clock::time_point give_up = Clock::now() + kPatience;
  while (!endpoint.matched(settings.peers)) {
    if (Clock::now() > give_up) throw std::runtime_error{"the Fast DDS echo peers did not appear"};
    ::usleep(10000);
  }

  wire::DisplacementCommand command = echo_command_sample();
  std::vector<double> times_us;
  times_us.reserve(static_cast<std::size_t>(settings.samples));
  for (int i = 0; i < settings.warm_up + settings.samples; ++i) {
    command.points()[0].step(i);
    collector.expect(i);
    const Clock::time_point start = Clock::now();
    bool answered = false;
    while (!answered) {
      endpoint.writer->write(&command);
      constexpr std::chrono::milliseconds kRepeat{200};
      answered = by_listener ? collector.wait(kRepeat) : collector.wait(wait_set, endpoint.reader, kRepeat);
      if (!answered && Clock::now() > start + kPatience) throw std::runtime_error{"an echo peer stopped answering"};
    }
    const std::chrono::duration<double, std::micro> round_trip = Clock::now() - start;
    if (i >= settings.warm_up) times_us.push_back(round_trip.count());
  }
  return times_us;
}

}  // namespace hybridtest::benchmarks
