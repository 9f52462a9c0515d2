// A DDS program that knows nothing of ours: it links Fast DDS alone and no generated type. It discovers a topic, takes
// the type of its messages from the network, and prints every message that it hears, one line for each value:
//   participant=storey_1
//   signals[0].name=displacement
//   signals[0].last[7]=0.0125
//   end
//
//   foreign_listener DOMAIN PARTITION TOPIC
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/types/DynamicDataFactory.h>
#include <fastrtps/types/DynamicPubSubType.h>
#include <fastrtps/types/DynamicTypeMember.h>
#include <fastrtps/utils/IPLocator.h>
#include <unistd.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>

#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace foreign_listener {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace types = eprosima::fastrtps::types;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;

types::TypeDescriptor described(const types::DynamicType_ptr& type) {
  types::TypeDescriptor descriptor;
  type->get_descriptor(&descriptor);
  return descriptor;
}

std::string joined(const std::string& path, const std::string& name) {
  if (path.empty()) return name;
  std::string longer = path;
  return longer.append(".").append(name);
}

void print(types::DynamicData& data, const types::DynamicType_ptr& type, const std::string& path);

template <class Value>
void print_value(const std::string& path, const char* format, Value value) {
  std::printf("%s=", path.c_str());
  std::printf(format, value);
  std::printf("\n");
}

/// One member of a structure or one element of a sequence.
void print_member(types::DynamicData& data, types::MemberId id, types::DynamicType_ptr type, const std::string& path) {
  while (type->get_kind() == types::TK_ALIAS) type = described(type).get_base_type();
  switch (type->get_kind()) {
    case types::TK_FLOAT64: {
      double value = 0.0;
      data.get_float64_value(value, id);
      return print_value(path, "%.17g", value);
    }
    case types::TK_UINT64: {
      std::uint64_t value = 0;
      data.get_uint64_value(value, id);
      return print_value(path, "%llu", static_cast<unsigned long long>(value));
    }
    case types::TK_UINT16: {
      std::uint16_t value = 0;
      data.get_uint16_value(value, id);
      return print_value(path, "%u", static_cast<unsigned>(value));
    }
    case types::TK_BYTE: {
      types::octet value = 0;
      data.get_byte_value(value, id);
      return print_value(path, "%u", static_cast<unsigned>(value));
    }
    case types::TK_STRING8: {
      std::string value;
      data.get_string_value(value, id);
      return print_value(path, "%s", value.c_str());
    }
    default: {
      types::DynamicData* inner = data.loan_value(id);
      if (inner == nullptr) return print_value(path, "%s", "?");
      print(*inner, type, path);
      data.return_loaned_value(inner);
    }
  }
}

void print(types::DynamicData& data, const types::DynamicType_ptr& type, const std::string& path) {
  if (type->get_kind() == types::TK_STRUCTURE) {
    std::map<types::MemberId, types::DynamicTypeMember*> members;
    type->get_all_members(members);
    for (const auto& [id, member] : members) {
      const std::string name = member->get_name();
      print_member(data, id, member->get_descriptor()->get_type(), joined(path, name));
    }
    return;
  }
  if (type->get_kind() == types::TK_SEQUENCE || type->get_kind() == types::TK_ARRAY) {
    for (std::uint32_t i = 0; i < data.get_item_count(); ++i) {
      print_member(data, i, described(type).get_element_type(), path + "[" + std::to_string(i) + "]");
    }
    return;
  }
  print_value(path, "%s", "?");
}

/// Reads the topic once its type is known.
class Listener final : public dds::DomainParticipantListener {
 public:
  Listener(std::string partition, std::string topic) : partition_{std::move(partition)}, topic_{std::move(topic)} {}

  /// Waits until the type has arrived, then creates the reader.
  void open(dds::DomainParticipant& participant) {
    types::DynamicType_ptr type;
    {
      std::unique_lock lock{mutex_};
      type_arrived_.wait(lock, [this] { return type_ != nullptr; });
      type = type_;
    }
    const dds::TypeSupport support{new types::DynamicPubSubType{type}};
    participant.register_type(support, type_name_);
    dds::Topic* topic = participant.create_topic(topic_, type_name_, dds::TOPIC_QOS_DEFAULT);
    dds::SubscriberQos subscriber_qos;
    subscriber_qos.partition().push_back(partition_.c_str());
    dds::Subscriber* subscriber = participant.create_subscriber(subscriber_qos);
    dds::DataReaderQos qos;
    qos.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
    reader_ = topic == nullptr ? nullptr : subscriber->create_datareader(topic, qos, this);
    if (reader_ == nullptr) {
      std::fprintf(stderr, "no reader of this type\n");
      std::_Exit(1);
    }
  }

 private:
  /// Discovery has told what identifies the type of a topic. Asks for the type where that is not enough to build it.
  void on_type_information_received(dds::DomainParticipant* participant, const eprosima::fastrtps::string_255 topic,
                                    const eprosima::fastrtps::string_255 type_name,
                                    const types::TypeInformation& information) override {
    if (topic_ != topic.c_str()) return;
    std::function<void(const std::string&, const types::DynamicType_ptr)> take =
        [this](const std::string& name, const types::DynamicType_ptr type) { keep(name, type); };
    const std::string name = type_name.c_str();
    participant->register_remote_type(information, name, take);
    const dds::TypeSupport built = participant->find_type(name);
    if (auto* type = dynamic_cast<types::DynamicPubSubType*>(built.get())) keep(name, type->GetDynamicType());
  }

  void keep(const std::string& name, const types::DynamicType_ptr& type) {
    const std::lock_guard lock{mutex_};
    type_name_ = name;
    type_ = type;
    type_arrived_.notify_one();
  }

  void on_data_available(dds::DataReader* reader) override {
    types::DynamicData* data = types::DynamicDataFactory::get_instance()->create_data(type_);
    dds::SampleInfo info;
    while (reader->take_next_sample(data, &info) == types::ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      print(*data, type_, "");
      std::printf("end\n");
      std::fflush(stdout);
    }
    types::DynamicDataFactory::get_instance()->delete_data(data);
  }

  const std::string partition_;
  const std::string topic_;
  std::condition_variable type_arrived_;
  std::mutex mutex_;  // guards the type until the reader exists
  std::string type_name_;
  types::DynamicType_ptr type_;
  dds::DataReader* reader_ = nullptr;
};

/// Discovery on this machine alone, as the tests use it.
dds::DomainParticipantQos loopback() {
  dds::DomainParticipantQos qos;
  const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.emplace_back("127.0.0.1");
  udp->maxInitialPeersRange = 200;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  Locator_t here;
  here.kind = LOCATOR_KIND_UDPv4;
  IPLocator::setIPv4(here, "127.0.0.1");
  qos.wire_protocol().builtin.metatrafficUnicastLocatorList.push_back(here);
  qos.wire_protocol().builtin.initialPeersList.push_back(here);
  qos.wire_protocol().builtin.typelookup_config.use_client = true;
  return qos;
}

int listen(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: foreign_listener DOMAIN PARTITION TOPIC\n");
    return 2;
  }
  Listener listener{argv[2], argv[3]};
  dds::DomainParticipant* participant = dds::DomainParticipantFactory::get_instance()->create_participant(
      static_cast<std::uint32_t>(std::atoi(argv[1])), loopback(), &listener, dds::StatusMask::none());
  if (participant == nullptr) return 1;
  listener.open(*participant);
  while (true) ::pause();  // until it is killed
}

}  // namespace
}  // namespace foreign_listener

int main(int argc, char** argv) { return foreign_listener::listen(argc, argv); }
