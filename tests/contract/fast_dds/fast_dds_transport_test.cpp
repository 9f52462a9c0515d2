// What the Fast DDS transport does beyond the common contract: processes that are killed, stall or send invalid
// messages; settings.

#include "transport/fast_dds/fast_dds_transport.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/config_error.hpp"
#include "tests/contract/fast_dds/fast_dds_networks.hpp"
#include "tests/contract/networks.hpp"
#include "tests/contract/sample_messages.hpp"
#include "tests/support/rtps_packets.hpp"
#include "tests/support/started_program.hpp"
#include "tests/unit/recording/temporary_directory.hpp"
#include "transport/fast_dds/dds_version.hpp"
#include "transport/fast_dds/participant_qos.hpp"
#include "transport/fast_dds/topics.hpp"

namespace hybridtest {
namespace {

/// A process that takes part in the test `name` as `peer`, repeating its status, until killed.
class PeerProcess {
 public:
  explicit PeerProcess(std::string name) {
    std::string program = CONTRACT_PEER_PROGRAM;
    char* arguments[] = {program.data(), name.data(), nullptr};
    if (::posix_spawn(&process_, program.c_str(), nullptr, nullptr, arguments, environ) != 0) {
      throw std::runtime_error{"cannot start " + program};
    }
  }
  ~PeerProcess() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  PeerProcess(const PeerProcess&) = delete;
  PeerProcess& operator=(const PeerProcess&) = delete;

  void signal(int number) const { ASSERT_EQ(::kill(process_, number), 0); }

 private:
  pid_t process_ = 0;
};

/// Takes statuses until one of `peer` in `state` comes.
[[nodiscard]] bool hears(Transport& observer, Inbox<ParticipantStatus>& statuses, LifecycleState state) {
  return eventually(observer, [&] {
    ParticipantStatus status;
    while (statuses.take(status)) {
      if (status.id == ParticipantId{"peer"} && status.state == state) return true;
    }
    return false;
  });
}

// The lease limits the silence; the operating system may add as much again under load.
constexpr Duration kLossTime = 2 * kTestLease;

TEST(FastDdsTransport, ReportsKilledProcessLostWithinLease) {
  const auto observer = FastDdsUdpNetwork::join(unique_test_name());
  const auto statuses = observer->status_inbox();
  const PeerProcess peer{unique_test_name()};
  ASSERT_TRUE(hears(*observer, *statuses, LifecycleState::running));
  peer.signal(SIGKILL);
  const auto killed = std::chrono::steady_clock::now();
  ASSERT_TRUE(hears(*observer, *statuses, LifecycleState::lost));
  EXPECT_LE(std::chrono::steady_clock::now() - killed, kLossTime);
}

TEST(FastDdsTransport, FrozenProcessIsLostAndReturnsWhenResumed) {
  const auto observer = FastDdsUdpNetwork::join(unique_test_name());
  const auto statuses = observer->status_inbox();
  const PeerProcess peer{unique_test_name()};
  ASSERT_TRUE(hears(*observer, *statuses, LifecycleState::running));
  peer.signal(SIGSTOP);
  const auto stopped = std::chrono::steady_clock::now();
  ASSERT_TRUE(hears(*observer, *statuses, LifecycleState::lost));
  EXPECT_LE(std::chrono::steady_clock::now() - stopped, kLossTime);
  peer.signal(SIGCONT);
  EXPECT_TRUE(hears(*observer, *statuses, LifecycleState::running));
}

TEST(FastDdsTransport, StalledParticipantIsLostWhileMotionIsPossible) {
  const auto observer = FastDdsUdpNetwork::join(unique_test_name());
  const auto statuses = observer->status_inbox();
  const auto peer = FastDdsUdpNetwork::join(unique_test_name());
  const auto status = peer->status_outbox();
  status->send(sample_status("peer", LifecycleState::armed));  // and never again, yet its process lives
  ASSERT_TRUE(hears(*observer, *statuses, LifecycleState::armed));
  EXPECT_TRUE(hears(*observer, *statuses, LifecycleState::lost));
  EXPECT_GE(observer->counters().deadlines_missed, 1U);
}

// Messages wait for the thread that reads them, and the departure does not: here that thread is away.
TEST(FastDdsTransport, LastWordsAreHeardBeforeTheDeparture) {
  const auto observer = FastDdsUdpNetwork::join(unique_test_name());
  const auto statuses = observer->status_inbox();
  for (int leaver = 0; leaver < 5; ++leaver) {
    auto peer = FastDdsUdpNetwork::join(unique_test_name());
    auto status = peer->status_outbox();
    status->send(sample_status("peer", LifecycleState::running));
    ASSERT_TRUE(hears(*observer, *statuses, LifecycleState::running));
    status->send(sample_status("peer", LifecycleState::finished));
    status.reset();
    ParticipantStatus last;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{10};
    while (!statuses->take(last)) ASSERT_LT(std::chrono::steady_clock::now(), deadline);
    EXPECT_EQ(last.state, LifecycleState::finished) << "leaver " << leaver;
    while (statuses->take(last)) EXPECT_NE(last.state, LifecycleState::lost) << "leaver " << leaver;
  }
}

TEST(FastDdsTransport, SilentParticipantIsNotLostBeforeMotionIsPossible) {
  const auto observer = FastDdsUdpNetwork::join(unique_test_name());
  const auto statuses = observer->status_inbox();
  const auto connecting = FastDdsUdpNetwork::join(unique_test_name());
  const auto connecting_status = connecting->status_outbox();
  ParticipantStatus slow = sample_status("slow", LifecycleState::ready);
  connecting_status->send(slow);
  // Another that stalls later shows that the deadline of the first has passed as well.
  ASSERT_TRUE(eventually(*observer, [&] { return statuses->take(slow); }));
  const auto peer = FastDdsUdpNetwork::join(unique_test_name());
  const auto status = peer->status_outbox();
  status->send(sample_status("peer", LifecycleState::armed));
  bool slow_lost = false;
  ASSERT_TRUE(eventually(*observer, [&] {
    ParticipantStatus received;
    while (statuses->take(received)) {
      if (received.state != LifecycleState::lost) continue;
      if (received.id == ParticipantId{"peer"}) return true;
      slow_lost = true;
    }
    return false;
  }));
  EXPECT_FALSE(slow_lost);
}

TEST(FastDdsTransport, SubstructureHearsCoordinatorAndItsOwnIdAlone) {
  const auto join_as = [](const std::string& id) {
    fast_dds::FastDdsSettings settings = test_settings();
    settings.substructure_id = id;
    return fast_dds::make_fast_dds_transport(settings, unique_test_name());
  };
  const auto site = join_as("site");
  const auto statuses = site->status_inbox();
  const auto observer = join_as("");
  const auto all = observer->status_inbox();
  const auto other = join_as("other");
  const auto other_status = other->status_outbox();
  const auto same = join_as("site");
  const auto same_status = same->status_outbox();
  const auto coordinator = join_as("");
  const auto coordinator_status = coordinator->status_outbox();
  other_status->send(sample_status("other"));

  // Once the observer has heard the other one, so would the site have.
  ParticipantStatus received;
  ASSERT_TRUE(eventually(*observer, [&] { return all->take(received) && received.id == ParticipantId{"other"}; }));
  same_status->send(sample_status("site"));
  coordinator_status->send(sample_status("coordinator"));
  std::set<std::string> heard;
  const auto take_all = [&] {
    while (statuses->take(received)) heard.insert(received.id.text());
  };
  ASSERT_TRUE(eventually(*site, [&] { return take_all(), heard.size() >= 2; }));
  EXPECT_EQ(heard, (std::set<std::string>{"coordinator", "site"}));
  std::set<std::string> heard_by_all{"other"};
  EXPECT_TRUE(eventually(*observer, [&] {
    while (all->take(received)) heard_by_all.insert(received.id.text());
    return heard_by_all.size() == 3;
  }));
}

/// Writes any bytes under the name of a valid type.
class ForgedType final : public fast_dds::dds::TopicDataType {
 public:
  explicit ForgedType(std::vector<std::uint8_t> bytes) : bytes_{std::move(bytes)} {
    setName("hybridtest::wire::TestControl");
    m_typeSize = 256;
  }
  bool serialize(void*, fast_dds::Payload* payload) override {
    std::copy(bytes_.begin(), bytes_.end(), payload->data);
    payload->length = static_cast<std::uint32_t>(bytes_.size());
    return true;
  }
  bool deserialize(fast_dds::Payload*, void*) override { return false; }
  std::function<std::uint32_t()> getSerializedSizeProvider(void*) override {
    return [size = bytes_.size()] { return static_cast<std::uint32_t>(size); };
  }
  void* createData() override { return new int; }
  void deleteData(void* sample) override { delete static_cast<int*>(sample); }
  bool getKey(void*, fast_dds::InstanceHandle*, bool) override { return false; }

 private:
  std::vector<std::uint8_t> bytes_;
};

struct Forgery {
  const char* name;
  std::vector<std::uint8_t> bytes;
};

/// The value of `key` in the first message that starts after `begin`, as the foreign listener prints it.
std::string printed(const std::string& text, const std::string& key) {
  const auto place = text.find("\n" + key + "=");
  if (place == std::string::npos) return "not printed: " + key;
  const auto value = place + key.size() + 2;
  return text.substr(value, text.find('\n', value) - value);
}

TEST(FastDdsTransport, ForeignProgramReadsLiveSignalsByTheirPublishedType) {
  TemporaryDirectory folder;
  StartedProgram listener{CONTRACT_FOREIGN_LISTENER,
                          {std::to_string(kTestDomain), unique_test_name(), "hybridtest/4/signal_block"},
                          folder / "listener"};
  // A substructure sends, and the coordinator describes the type.
  const auto coordinator = FastDdsUdpNetwork::join(unique_test_name());
  const auto coordinator_signals = coordinator->signal_outbox();
  fast_dds::FastDdsSettings settings = test_settings();
  settings.substructure_id = "storey_1";
  const auto sender = fast_dds::make_fast_dds_transport(settings, unique_test_name());
  const auto outbox = sender->signal_outbox();
  SignalBlock block = sample_signals();
  block.signals[5].last[3] = -0.12345678901234567;
  ASSERT_TRUE(wait_until([&] {
    outbox->send(block);
    return listener.standard_output().find("\nend\n") != std::string::npos;
  })) << listener.standard_error();
  const std::string text = "\n" + listener.standard_output();
  EXPECT_EQ(printed(text, "participant"), "storey_1");
  EXPECT_EQ(printed(text, "group"), "control");
  EXPECT_EQ(printed(text, "part"), "3");
  EXPECT_EQ(printed(text, "sequence_number"), "1048576");
  EXPECT_EQ(printed(text, "model_time_s[15]"), fmt::format("{:.17g}", block.model_time_s[15]));
  EXPECT_EQ(printed(text, "names"), "displacement") << "and more lines";
  EXPECT_EQ(printed(text, "units"), "m");
  EXPECT_EQ(printed(text, "limits[5]"), fmt::format("{:.17g}", 0.1));
  EXPECT_EQ(printed(text, "last[83]"), fmt::format("{:.17g}", block.signals[5].last[3]));
  EXPECT_EQ(printed(text, "most[255]"), "15.5");
}

class ForgedControl : public ::testing::TestWithParam<Forgery> {};

TEST_P(ForgedControl, IsDroppedAndCountedWithoutLosingLaterMessages) {
  namespace dds = fast_dds::dds;
  const auto receiver = FastDdsUdpNetwork::join(unique_test_name());
  const auto controls = receiver->control_inbox();

  auto* factory = dds::DomainParticipantFactory::get_instance();
  auto* forger = factory->create_participant(kTestDomain, fast_dds::participant_qos(test_settings()));
  ASSERT_NE(forger, nullptr);
  const dds::TypeSupport type{new ForgedType{GetParam().bytes}};
  type.register_type(forger);
  auto* topic = forger->create_topic("hybridtest/4/test_control", type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  dds::PublisherQos publisher_qos;
  publisher_qos.partition().push_back(unique_test_name().c_str());
  auto* writer = forger->create_publisher(publisher_qos)->create_datawriter(topic, dds::DATAWRITER_QOS_DEFAULT);
  int sample = 0;
  EXPECT_TRUE(eventually(*receiver, [&] {
    writer->write(&sample);
    return receiver->counters().malformed > 0;
  }));
  TestControl control;
  EXPECT_FALSE(controls->take(control));

  const auto sender = FastDdsUdpNetwork::join(unique_test_name());
  const auto outbox = sender->control_outbox();
  EXPECT_TRUE(eventually(*receiver, [&] {
    outbox->send(sample_control());
    return controls->take(control);
  }));
  EXPECT_EQ(control, sample_control());
  forger->delete_contained_entities();
  factory->delete_participant(forger);
}

// After the encapsulation header {0, 1, 0, 0}: verb, padding to 8, sender, role, reason.
INSTANTIATE_TEST_SUITE_P(
    FastDdsTransport, ForgedControl,
    ::testing::Values(Forgery{"cut_off", {0, 1, 0, 0, 4}}, Forgery{"unknown_encoding", {0x7f, 0x7f, 0, 0, 4}},
                      Forgery{"no_such_verb", {0, 1, 0, 0, 200, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0}}),
    [](const auto& forgery) { return forgery.param.name; });

TEST(FastDdsSettings, RejectsValuesOutOfRange) {
  const auto refused = [](auto change) {
    fast_dds::FastDdsSettings settings = test_settings();
    change(settings);
    EXPECT_THROW(static_cast<void>(fast_dds::participant_qos(settings)), ConfigError);
  };
  refused([](auto& s) { s.domain = 233; });
  refused([](auto& s) { s.loopback_participants = 0; });
  refused([](auto& s) { s.loopback_participants = 201; });
  refused([](auto& s) { s.lease = Duration{1}; });
  refused([](auto& s) { s.repair_period = Duration{1}; });
  refused([](auto& s) { s.heartbeat_deadline = Duration{1}; });
  refused([](auto& s) { s.initial_peers = {"127.0.0.1:"}; });
  refused([](auto& s) { s.initial_peers = {"127.0.0.1:70000"}; });
  refused([](auto& s) { s.initial_peers = {"127.0.0.1:7x"}; });
  refused([](auto& s) { s.initial_peers = {""}; });
  refused([](auto& s) { s.initial_peers = {"no.such.host.invalid"}; });
  refused([](auto& s) { s.discovery_server = ":11811"; });
  EXPECT_NO_THROW(static_cast<void>(fast_dds::participant_qos(test_settings())));
}

TEST(FastDdsSettings, NamesTheSettingThatIsWrong) {
  fast_dds::FastDdsSettings settings = test_settings();
  settings.initial_peers = {"lab:70000"};
  EXPECT_THAT([&] { fast_dds::require_usable(settings); },
              ::testing::ThrowsMessage<ConfigError>("peer 'lab:70000': expected host or host:port, port 1 to 65535"));
  settings = test_settings();
  settings.discovery_server = "lab:x";
  EXPECT_THAT(
      [&] { fast_dds::require_usable(settings); },
      ::testing::ThrowsMessage<ConfigError>("discovery server 'lab:x': expected host or host:port, port 1 to 65535"));
  settings = test_settings();
  settings.profile_file = "nowhere.xml";
  EXPECT_THAT(
      [&] { fast_dds::require_usable(settings); },
      ::testing::ThrowsMessage<ConfigError>("nowhere.xml: cannot be read: no such file; expected Fast DDS XML with a "
                                            "participant profile named 'hybridtest'"));
}

TEST(FastDdsSettings, RejectsInvalidTestName) {
  for (const std::string& name : {std::string{}, std::string{"a*"}, std::string{"a/b"}, std::string(65, 'a')}) {
    EXPECT_THROW(static_cast<void>(fast_dds::make_fast_dds_transport(test_settings(), name)), ConfigError);
  }
}

class ProfileFile : public ::testing::Test {
 protected:
  fast_dds::FastDdsSettings settings_with(const std::string& text) {
    std::ofstream{path_} << text;
    fast_dds::FastDdsSettings settings = test_settings();
    settings.profile_file = path_;
    return settings;
  }
  ~ProfileFile() override { std::filesystem::remove(path_); }

 private:
  const std::filesystem::path path_ = std::filesystem::path{::testing::TempDir()} / (unique_test_name() + ".xml");
};

// Fast DDS keeps the profiles of every file that a process has read: this test comes first.
TEST_F(ProfileFile, RejectsInvalidFileAndMissingProfile) {
  EXPECT_THROW(static_cast<void>(fast_dds::participant_qos(settings_with("no xml"))), ConfigError);
  EXPECT_THROW(static_cast<void>(fast_dds::participant_qos(settings_with(R"(<?xml version="1.0" encoding="UTF-8"?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <participant profile_name="somebody_else"><rtps/></participant>
</profiles>)"))),
               ConfigError);
}

TEST_F(ProfileFile, ReplacesTransportsAndPeersButNotTheLease) {
  const fast_dds::FastDdsSettings settings = settings_with(R"(<?xml version="1.0" encoding="UTF-8"?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <participant profile_name="hybridtest">
    <rtps><participantID>17</participantID></rtps>
  </participant>
</profiles>)");
  const auto qos = fast_dds::participant_qos(settings);
  EXPECT_EQ(qos.wire_protocol().participant_id, 17);
  EXPECT_EQ(qos.wire_protocol().builtin.discovery_config.leaseDuration, fast_dds::to_dds(20 * kTestLease));

  // Its transports, here those that Fast DDS has anyway, pass the packet filter.
  const auto transport = fast_dds::make_fast_dds_transport(settings, unique_test_name());
  constexpr std::uint16_t kOfParticipant = 2 * 17;
  constexpr std::uint16_t kFirst = 7400 + 250 * kTestDomain;
  for (const int offset : {10, 11}) {  // of discovery and of messages, RTPS 9.6.1.1
    EXPECT_TRUE(send_to(static_cast<std::uint16_t>(kFirst + kOfParticipant + offset), gap_up_to(5)));
    EXPECT_TRUE(
        send_to(static_cast<std::uint16_t>(kFirst + kOfParticipant + offset), gap_up_to(std::uint64_t{1} << 60U)));
  }
  EXPECT_TRUE(wait_until([&] { return transport->counters().refused_harmful >= 2; }));
  EXPECT_EQ(transport->counters().refused_harmful, 2U);
}

}  // namespace
}  // namespace hybridtest
