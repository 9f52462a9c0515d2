#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fastdds/rtps/transport/ChainingTransport.h>
#include <algorithm>
#include <array>
#include <atomic>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fstream>
#include <functional>
#include <initializer_list>
#include <mutex>
#include <optional>
#include <vector>

#include "tests/contract/fast_dds/fast_dds_networks.hpp"
#include "tests/contract/networks.hpp"
#include "tests/contract/sample_messages.hpp"
#include "tests/support/rtps_packets.hpp"
#include "tests/support/started_program.hpp"
#include "transport/fast_dds/participant_qos.hpp"
#include "transport/fast_dds/ports.hpp"
#include "transport/fast_dds/receiving_transport.hpp"

/// Packets of somebody who is no participant: a command that was captured in one test and is sent again in another, and
/// messages of the protocol in the name of a participant.
namespace hybridtest::fast_dds {
namespace {

using Packet = std::vector<std::uint8_t>;
using Octet = eprosima::fastrtps::rtps::octet;

/// Packets as they came from the network.
struct Captured {
  std::mutex mutex;
  std::vector<Packet> packets;
};

/// UDP of Fast DDS that keeps a copy of everything that arrives.
struct TapDescriptor final : rtps::ChainingTransportDescriptor {
  TapDescriptor(std::shared_ptr<rtps::TransportDescriptorInterface> udp, std::shared_ptr<Captured> to)
      : ChainingTransportDescriptor{std::move(udp)}, captured{std::move(to)} {}
  [[nodiscard]] rtps::TransportInterface* create_transport() const override;
  std::shared_ptr<Captured> captured;
};

class Tap final : public ReceivingTransport {
 public:
  explicit Tap(const TapDescriptor& descriptor) : ReceivingTransport{descriptor}, descriptor_{descriptor} {}
  rtps::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }
  void receive(rtps::TransportReceiverInterface* receiver, const Octet* bytes, std::uint32_t count,
               const Locator& local, const Locator& remote) override {
    {
      const std::lock_guard lock{descriptor_.captured->mutex};
      descriptor_.captured->packets.emplace_back(bytes, bytes + count);
    }
    receiver->OnDataReceived(bytes, count, local, remote);
  }

 private:
  TapDescriptor descriptor_;
};

rtps::TransportInterface* TapDescriptor::create_transport() const { return new Tap{*this}; }

/// The first substructure of a test, which captures what it receives.
class CapturingSite : private dds::DataReaderListener {
 public:
  CapturingSite(const FastDdsSettings& settings, const std::string& test_name) {
    dds::DomainParticipantQos qos = participant_qos(settings);
    qos.transport().user_transports[0] = std::make_shared<TapDescriptor>(qos.transport().user_transports[0], captured_);
    participant_ = dds::DomainParticipantFactory::get_instance()->create_participant(settings.domain, qos);
    using Command = Topic<DisplacementCommand>;
    const dds::TypeSupport type{new Command::Type};
    type.register_type(participant_);
    dds::SubscriberQos subscriber_qos;
    subscriber_qos.partition().push_back((test_name + "/0").c_str());
    auto* topic = participant_->create_topic(Command::kName, type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
    reader_ = participant_->create_subscriber(subscriber_qos)
                  ->create_datareader(topic, reader_qos(Command::kDelivery, settings));
  }
  ~CapturingSite() override {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  CapturingSite(const CapturingSite&) = delete;
  CapturingSite& operator=(const CapturingSite&) = delete;

  [[nodiscard]] GuidPrefix prefix() const { return participant_->guid().guidPrefix; }
  [[nodiscard]] bool received() { return reader_->get_unread_count() > 0; }
  [[nodiscard]] std::vector<Packet> packets() {
    const std::lock_guard lock{captured_->mutex};
    return captured_->packets;
  }

 private:
  std::shared_ptr<Captured> captured_ = std::make_shared<Captured>();
  dds::DomainParticipant* participant_ = nullptr;
  dds::DataReader* reader_ = nullptr;
};

void replace(Packet& packet, const GuidPrefix& from, const GuidPrefix& to) {
  for (auto at = packet.begin();; at += GuidPrefix::size) {
    at = std::search(at, packet.end(), std::begin(from.value), std::end(from.value));
    if (at == packet.end()) return;
    std::copy(std::begin(to.value), std::end(to.value), at);
  }
}

/// Sends to the sockets for messages, or for discovery, of all participants of the domain on this machine.
void send_to_everyone(const std::vector<Packet>& packets, std::uint32_t domain, bool is_discovery = false) {
  const PortParameters ports;
  const std::uint32_t offset = is_discovery ? ports.offsetd1 : ports.offsetd3;
  for (const Packet& packet : packets) {
    for (std::uint32_t participant = 0; participant < 119; ++participant) {
      send_to(static_cast<std::uint16_t>(ports.portBase + ports.domainIDGain * domain + offset +
                                         ports.participantIDGain * participant),
              packet);
    }
  }
}

void append(Packet& packet, std::initializer_list<int> more) {
  for (const int one : more) packet.push_back(static_cast<std::uint8_t>(one));
}

Packet packet_of(const GuidPrefix& sender) {
  Packet packet{'R', 'T', 'P', 'S', 2, 3, 1, 15};
  packet.insert(packet.end(), std::begin(sender.value), std::end(sender.value));
  return packet;
}

/// As Fast DDS sends it when this participant leaves.
Packet leaving_notice(const GuidPrefix& participant) {
  Packet packet = packet_of(participant);
  append(packet, {0x15, 3, 52, 0, 0, 0, 16, 0, 0, 1, 0, 0xc7, 0, 1, 0, 0xc2, 1, 0, 0, 0, 0, 0, 0, 0, 0x70, 0, 16, 0});
  packet.insert(packet.end(), std::begin(participant.value), std::end(participant.value));
  append(packet, {0, 0, 1, 0xc1, 0x71, 0, 4, 0, 0, 0, 0, 3, 1, 0, 0, 0});
  return packet;
}

/// No message of this writer between the first one and 2^60 comes any more.
Packet endless_gap(const GuidPrefix& participant, const std::array<std::uint8_t, 4>& writer) {
  std::array<std::uint8_t, GuidPrefix::size> prefix{};
  std::ranges::copy(participant.value, prefix.begin());
  return gap_up_to(std::uint64_t{1} << 60U, prefix, writer);
}

class Replay : public ::testing::Test {
 protected:
  Replay() { std::filesystem::create_directories(folder_); }
  ~Replay() override { std::filesystem::remove_all(folder_); }

  /// Credentials of a test with one substructure.
  void make_credentials() {
    const std::filesystem::path scenario_reader = folder_ / "reader";
    std::ofstream{scenario_reader} << "#!/bin/sh\nprintf 'test " << test_ << "\\nsubstructure site\\n'\n";
    std::filesystem::permissions(scenario_reader, std::filesystem::perms::owner_all);
    StartedProgram script{std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "launch/security/make_credentials",
                          {"none.yaml", "--out", folder_ / "credentials", "--hybridtest", scenario_reader},
                          folder_ / "script"};
    ASSERT_THAT(script.wait(), ::testing::Optional(0)) << script.standard_error();
    is_secured_ = true;
  }

  [[nodiscard]] FastDdsSettings settings(const std::string& who) const {
    FastDdsSettings settings = test_settings();
    if (is_secured_) settings.credentials = folder_ / "credentials" / who;
    return settings;
  }

  /// @return the steps of the commands that the site of the second test took, until a true one or the captured one.
  std::vector<Step> replay() {
    constexpr Step kCapturedStep = 7;
    constexpr Step kTrueStep = 8;
    GuidPrefix old_coordinator;
    GuidPrefix old_site;
    std::vector<Packet> packets;
    {
      Participant coordinator{settings("coordinator")};
      DdsOutbox<DisplacementCommand> commands{coordinator, test_ + "/0", matches_};
      CapturingSite site{settings("site"), test_};
      old_coordinator = coordinator.prefix();
      old_site = site.prefix();
      EXPECT_TRUE(wait_until([&] { return matches_->has(old_site); }));
      const std::size_t before = site.packets().size();
      EXPECT_TRUE(commands.send(sample_command(0, kCapturedStep)));
      EXPECT_TRUE(wait_until([&] { return site.received(); }));
      packets = site.packets();
      packets.erase(packets.begin(), packets.begin() + static_cast<std::ptrdiff_t>(before));
    }
    EXPECT_FALSE(packets.empty());

    // Another day, the same names: the intruder puts the new identities, which are not secret, into the old packets.
    Participant coordinator{settings("coordinator")};
    DdsOutbox<DisplacementCommand> commands{coordinator, test_ + "/0", matches_};
    Participant site{settings("site")};
    const auto senders = std::make_shared<Matches>();
    DdsInbox<DisplacementCommand> received{site, test_ + "/0", senders};
    EXPECT_TRUE(wait_until([&] { return matches_->has(site.prefix()) && senders->has(coordinator.prefix()); }));
    std::vector<Packet> altered = packets;
    for (Packet& packet : altered) {
      replace(packet, old_coordinator, coordinator.prefix());
      replace(packet, old_site, site.prefix());
    }
    send_to_everyone(packets, kTestDomain);
    send_to_everyone(altered, kTestDomain);
    commands.send(sample_command(0, kTrueStep));
    std::vector<Step> steps;
    EXPECT_TRUE(wait_until([&] {
      static_cast<void>(site.waker.wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds{5}));
      DisplacementCommand command;
      while (received.take(command)) steps.push_back(command.newest().step);
      return !steps.empty();
    }));
    return steps;
  }

  const std::string test_ = unique_test_name();
  const std::filesystem::path folder_ = std::filesystem::temp_directory_path() / test_;
  const std::shared_ptr<Matches> matches_ = std::make_shared<Matches>();

 private:
  bool is_secured_ = false;
};

TEST_F(Replay, CapturedCommandOfAnotherTestIsNotTaken) {
  ASSERT_NO_FATAL_FAILURE(make_credentials());
  EXPECT_THAT(replay(), ::testing::ElementsAre(8));
}

TEST_F(Replay, WithoutCredentialsACapturedCommandIsTaken) { EXPECT_EQ(replay().front(), 7); }

/// Messages of the protocol in the name of a participant.
class Forgery : public Replay {
 protected:
  /// A coordinator gets forged notices that its site has left.
  /// @param until   that it must wait for.
  /// @return how often it believed it.
  int departures(const FastDdsSettings& of_coordinator, const std::function<bool(int)>& until) {
    std::atomic<int> count{0};
    Participant coordinator{of_coordinator};
    DdsOutbox<DisplacementCommand> commands{coordinator, test_ + "/0", matches_};
    Participant site{settings("site")};
    DdsInbox<DisplacementCommand> received{site, test_ + "/0", std::make_shared<Matches>()};
    const std::size_t action = coordinator.on_departure([&](const GuidPrefix& who) { count += who == site.prefix(); });
    EXPECT_TRUE(wait_until([&] { return matches_->has(site.prefix()); }));
    EXPECT_TRUE(wait_until([&] {
      send_to_everyone({leaving_notice(site.prefix())}, kTestDomain, true);
      return until(count);
    }));
    coordinator.forget(action);
    return count;
  }
};

TEST_F(Forgery, NoticeOfLeavingIsNotBelieved) {
  ASSERT_NO_FATAL_FAILURE(make_credentials());
  // Whoever has found another site since has also read the notices before.
  std::optional<Participant> another;
  std::optional<DdsInbox<DisplacementCommand>> its_inbox;
  int rounds = 0;
  const int believed = departures(settings("coordinator"), [&](int) {
    if (++rounds < 100) return false;
    if (!another) {
      another.emplace(settings("site"));
      its_inbox.emplace(*another, test_ + "/0", std::make_shared<Matches>());
    }
    return matches_->has(another->prefix());
  });
  EXPECT_EQ(believed, 0);
}

/// Control: Fast DDS alone believes it, CVE-2023-50257.
TEST_F(Forgery, FastDdsBelievesANoticeOfLeaving) {
  ASSERT_NO_FATAL_FAILURE(make_credentials());
  FastDdsSettings bare = settings("coordinator");
  bare.receives_in_waiting_thread = false;
  EXPECT_GT(departures(bare, [](int count) { return count > 0; }), 0);
}

TEST_F(Forgery, EndlessGapDoesNotHangAReader) {
  Participant coordinator{settings("coordinator")};
  DdsOutbox<DisplacementCommand> commands{coordinator, test_ + "/0", matches_};
  Participant site{settings("site")};
  const auto senders = std::make_shared<Matches>();
  DdsInbox<DisplacementCommand> received{site, test_ + "/0", senders};
  ASSERT_TRUE(wait_until([&] { return matches_->has(site.prefix()) && senders->has(coordinator.prefix()); }));
  // Writers are counted; this is one of the first.
  std::vector<Packet> gaps;
  for (std::uint8_t writer = 0; writer < 32; ++writer) {
    for (const std::uint8_t kind : std::array<std::uint8_t, 2>{2, 3})
      gaps.push_back(endless_gap(coordinator.prefix(), {0, 0, writer, kind}));
  }
  send_to_everyone(gaps, kTestDomain);
  commands.send(sample_command(0, 8));
  DisplacementCommand command;
  EXPECT_TRUE(wait_until([&] {
    static_cast<void>(site.waker.wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds{5}));
    return received.take(command);
  }));
}

}  // namespace
}  // namespace hybridtest::fast_dds
