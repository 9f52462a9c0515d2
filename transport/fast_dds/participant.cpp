#include "transport/fast_dds/participant.hpp"

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <stdexcept>
#include <utility>

#include "core/config_error.hpp"
#include "transport/fast_dds/live_type.hpp"
#include "transport/fast_dds/participant_qos.hpp"

namespace hybridtest::fast_dds {
namespace {

template <class Entity>
Entity* created(Entity* entity, const char* what) {
  if (entity == nullptr) throw std::runtime_error{std::string{"Fast DDS could not create the "} + what};
  return entity;
}

/// With credentials, Fast DDS makes no endpoint that they do not permit.
template <class Entity>
Entity* permitted(Entity* entity, const FastDdsSettings& settings, const char* verb, dds::Topic& topic,
                  const Partitions& partitions) {
  if (entity == nullptr && settings.credentials) {
    throw ConfigError{{ConfigIssue{.file = settings.credentials->string(),
                                   .what = std::string{"these credentials do not permit to "} + verb + " '" +
                                           topic.get_name() + "' in '" + partitions.names.front() +
                                           "'; use the folder of this participant and this test"}}};
  }
  return created(entity, "endpoint");
}

std::shared_ptr<PolledSocket> socket_for(const FastDdsSettings& settings) {
  const bool reads_itself = settings.receives_in_waiting_thread && !settings.profile_file && !settings.tcp;
  return reads_itself ? std::make_shared<PolledSocket>(settings.busy_poll, settings.when_woken) : nullptr;
}

template <class Qos>
void add(const Partitions& partitions, Qos& qos) {
  for (const std::string& name : partitions.names) qos.partition().push_back(name.c_str());
}

}  // namespace

Participant::Participant(const FastDdsSettings& settings) : socket_{socket_for(settings)}, settings_{settings} {
  turn_off_intraprocess_delivery();
  describe_live_type();
  const dds::DomainParticipantQos qos = participant_qos(settings_, socket_, refused_);
  participant_ = created(dds::DomainParticipantFactory::get_instance()->create_participant(settings_.domain, qos, this,
                                                                                           dds::StatusMask::none()),
                         settings_.credentials
                             ? "participant; it may have refused the credentials, see above"
                             : "participant; all UDP ports of the domain may be in use: choose another --domain");
}

Participant::~Participant() {
  participant_->set_listener(nullptr);
  participant_->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

dds::Topic* Participant::topic(const char* name, const std::function<dds::TypeSupport()>& make_type) {
  const std::lock_guard lock{mutex_};
  dds::Topic*& topic = topics_[name];
  if (topic == nullptr) {
    const dds::TypeSupport type = make_type();
    type.register_type(participant_);
    topic = created(participant_->create_topic(name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT), "topic");
  }
  return topic;
}

dds::DataWriter* Participant::create_writer(dds::Topic* topic, const Partitions& partitions,
                                            const dds::DataWriterQos& qos, dds::DataWriterListener* listener) {
  const std::lock_guard lock{mutex_};
  dds::Publisher*& publisher = publishers_[partitions];
  if (publisher == nullptr) {
    dds::PublisherQos publisher_qos;
    add(partitions, publisher_qos);
    publisher = created(participant_->create_publisher(publisher_qos), "publisher");
  }
  return permitted(publisher->create_datawriter(topic, qos, listener), settings_, "write", *topic, partitions);
}

void Participant::remove(dds::DataWriter* writer) noexcept {
  const std::lock_guard lock{mutex_};
  for (const auto& [partitions, publisher] : publishers_) {
    if (publisher->delete_datawriter(writer) == kReturnOk) return;
  }
}

dds::DataReader* Participant::create_reader(dds::Topic* topic, const Partitions& partitions,
                                            const dds::DataReaderQos& qos, dds::DataReaderListener* listener) {
  const std::lock_guard lock{mutex_};
  dds::Subscriber*& subscriber = subscribers_[partitions];
  if (subscriber == nullptr) {
    dds::SubscriberQos subscriber_qos;
    add(partitions, subscriber_qos);
    subscriber = created(participant_->create_subscriber(subscriber_qos), "subscriber");
  }
  return permitted(subscriber->create_datareader(topic, qos, listener), settings_, "read", *topic, partitions);
}

void Participant::remove(dds::DataReader* reader) noexcept {
  const std::lock_guard lock{mutex_};
  for (const auto& [partitions, subscriber] : subscribers_) {
    if (subscriber->delete_datareader(reader) == kReturnOk) return;
  }
}

std::size_t Participant::on_departure(std::function<void(const GuidPrefix&)> action) {
  const std::lock_guard lock{departure_mutex_};
  departure_actions_.emplace(++departure_count_, std::move(action));
  return departure_count_;
}

void Participant::forget(std::size_t departure_action) noexcept {
  const std::lock_guard lock{departure_mutex_};
  departure_actions_.erase(departure_action);
}

void Participant::on_participant_discovery(dds::DomainParticipant*, DiscoveryInfo&& info) {
  if (!participant_left(info)) return;
  const std::lock_guard lock{departure_mutex_};
  for (const auto& [number, action] : departure_actions_) action(prefix_of(info));
}

}  // namespace hybridtest::fast_dds
