#include "transport/fast_dds/tcp_transport.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/rtps_packets.hpp"
#include "transport/fast_dds/receiving_transport.hpp"

namespace hybridtest::fast_dds {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::uint16_t kLogicalPort = 7410;

Locator at(std::uint16_t logical_port, unsigned char last_of_address) {
  Locator locator;
  locator.kind = LOCATOR_KIND_TCPv4;
  IpLocator::setIPv4(locator, 192, 0, 2, last_of_address);
  IpLocator::setLogicalPort(locator, logical_port);
  return locator;
}

Locator with_port(Locator locator, std::uint16_t physical_port) {
  IpLocator::setPhysicalPort(locator, physical_port);
  return locator;
}

/// What happened to the lower transport and to a receiver, in its order.
class Log {
 public:
  void add(const std::string& what) {
    const std::lock_guard lock{mutex_};
    entries_.push_back(what);
    changed_.notify_all();
  }
  bool wait_for(const std::string& what, Duration patience) {
    std::unique_lock lock{mutex_};
    return changed_.wait_for(lock, patience, [&] { return std::ranges::find(entries_, what) != entries_.end(); });
  }
  std::vector<std::string> entries() {
    const std::lock_guard lock{mutex_};
    return entries_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::string> entries_;
};

/// In the place of TCP of Fast DDS.
struct LowerDescriptor final : rtps::ChainingTransportDescriptor {
  explicit LowerDescriptor(Log& its_log)
      : ChainingTransportDescriptor{std::make_shared<rtps::UDPv4TransportDescriptor>()}, log{&its_log} {}
  [[nodiscard]] rtps::TransportInterface* create_transport() const override;

  Log* log;
  /// Who gets what arrives at the port that was opened last.
  mutable rtps::TransportReceiverInterface* receiver = nullptr;
};

class LowerTransport final : public ReceivingTransport {
 public:
  explicit LowerTransport(const LowerDescriptor& descriptor)
      : ReceivingTransport{descriptor}, descriptor_{descriptor} {}

  rtps::TransportDescriptorInterface* get_configuration() override { return nullptr; }
  bool init(const eprosima::fastrtps::rtps::PropertyPolicy*) override {
    descriptor_.log->add("begins");
    return true;
  }
  bool OpenInputChannel(const Locator& locator, rtps::TransportReceiverInterface* receiver, std::uint32_t) override {
    descriptor_.receiver = receiver;
    descriptor_.log->add("opens " + std::to_string(IpLocator::getLogicalPort(locator)));
    return true;
  }
  bool CloseInputChannel(const Locator& locator) override {
    descriptor_.log->add("closes " + std::to_string(IpLocator::getLogicalPort(locator)));
    return true;
  }
  bool OpenOutputChannel(rtps::SendResourceList&, const Locator& locator) override {
    descriptor_.log->add("connects to " + IpLocator::toIPv4string(locator) + ":" +
                         std::to_string(IpLocator::getPhysicalPort(locator)));
    return true;
  }
  bool is_local_locator(const Locator& locator) const override {
    return IpLocator::toIPv4string(locator) == "127.0.0.1";
  }

 private:
  void receive(rtps::TransportReceiverInterface*, const eprosima::fastrtps::rtps::octet*, std::uint32_t, const Locator&,
               const Locator&) override {}
  const LowerDescriptor& descriptor_;
};

rtps::TransportInterface* LowerDescriptor::create_transport() const { return new LowerTransport{*this}; }

/// TCP as it is used, but on that lower transport and with a short quiet time.
std::shared_ptr<rtps::TransportDescriptorInterface> over(const std::shared_ptr<LowerDescriptor>& lower,
                                                         const std::optional<Locator>& own = std::nullopt,
                                                         Duration quiet = Duration{1}) {
  return tcp_transport(lower, own, Admission::plain, std::make_shared<RefusedPackets>(), quiet);
}

/// Takes in a message until the port is closed, at most for its patience.
class SlowReceiver final : public rtps::TransportReceiverInterface {
 public:
  SlowReceiver(Log& log, Duration patience) : log_{log}, patience_{patience} {}
  void OnDataReceived(const unsigned char*, std::uint32_t, const Locator&, const Locator&) override {
    log_.add("enters");
    log_.wait_for("is closed", patience_);
    log_.add("leaves");
  }

 private:
  Log& log_;
  const Duration patience_;
};

/// A message arrives, the port is closed while it is taken in, and another message arrives.
std::vector<std::string> closed_meanwhile(const rtps::TransportDescriptorInterface& descriptor,
                                          const LowerDescriptor& lower, Duration patience) {
  SlowReceiver receiver{*lower.log, patience};
  const std::unique_ptr<rtps::TransportInterface> transport{descriptor.create_transport()};
  EXPECT_TRUE(transport->OpenInputChannel(at(kLogicalPort, 1), &receiver, 1500));
  // What the lower transport was given; alone, it gives the receiver itself.
  rtps::TransportReceiverInterface& next = *lower.receiver;
  const auto arrives = [&] { next.OnDataReceived(nullptr, 0, {}, {}); };
  std::thread connection{arrives};
  EXPECT_TRUE(lower.log->wait_for("enters", seconds{20}));
  EXPECT_TRUE(transport->CloseInputChannel(at(kLogicalPort, 1)));
  lower.log->add("is closed");
  connection.join();
  arrives();
  return lower.log->entries();
}

TEST(TcpTransport, AcceptsConnectionsOnceAPortIsOpen) {
  Log log;
  const auto descriptor = over(std::make_shared<LowerDescriptor>(log));
  const std::unique_ptr<rtps::TransportInterface> transport{descriptor->create_transport()};
  EXPECT_TRUE(transport->init());
  EXPECT_THAT(log.entries(), IsEmpty());
  SlowReceiver receiver{log, Duration{0}};
  EXPECT_FALSE(transport->IsInputChannelOpen(at(kLogicalPort, 1)));
  EXPECT_TRUE(transport->OpenInputChannel(at(kLogicalPort, 1), &receiver, 1500));
  EXPECT_THAT(log.entries(), ElementsAre("opens 7410", "begins"));
  EXPECT_TRUE(transport->IsInputChannelOpen(at(kLogicalPort, 2))) << "a port is that of all addresses";
  EXPECT_TRUE(transport->OpenInputChannel(at(kLogicalPort + 2, 1), &receiver, 1500));
  EXPECT_THAT(log.entries(), ElementsAre("opens 7410", "begins", "opens 7412"));
}

TEST(TcpTransport, ClosingWaitsForWhoIsInside) {
  Log log;
  const auto lower = std::make_shared<LowerDescriptor>(log);
  EXPECT_THAT(closed_meanwhile(*over(lower), *lower, milliseconds{100}),
              ElementsAre("opens 7410", "begins", "enters", "leaves", "is closed"));
}

/// Control: without it, closing does not wait, and the next message is still passed on.
TEST(TcpTransport, WithoutItClosingWaitsForNobody) {
  Log log;
  const LowerDescriptor lower{log};
  EXPECT_THAT(closed_meanwhile(lower, lower, seconds{20}),
              ElementsAre("opens 7410", "enters", "closes 7410", "is closed", "leaves", "enters", "leaves"));
}

TEST(TcpTransport, LowerPortIsClosedAfterAQuietTime) {
  constexpr milliseconds kQuiet{50};
  Log log;
  const auto lower = std::make_shared<LowerDescriptor>(log);
  const auto descriptor = over(lower, std::nullopt, kQuiet);
  std::unique_ptr<rtps::TransportInterface> transport{descriptor->create_transport()};
  SlowReceiver receiver{log, Duration{0}};
  EXPECT_TRUE(transport->OpenInputChannel(at(kLogicalPort, 1), &receiver, 1500));
  EXPECT_TRUE(transport->CloseInputChannel(at(kLogicalPort, 1)));
  EXPECT_THAT(log.entries(), ElementsAre("opens 7410", "begins")) << "only at the end";
  const auto arrived = std::chrono::steady_clock::now();
  lower->receiver->OnDataReceived(nullptr, 0, {}, {});
  transport.reset();
  EXPECT_GE(std::chrono::steady_clock::now() - arrived, kQuiet);
  EXPECT_THAT(log.entries(), ElementsAre("opens 7410", "begins", "closes 7410"));
}

TEST(TcpTransport, NobodyConnectsToHimself) {
  Log log;
  const Locator own = with_port(at(kLogicalPort, 1), 5100);
  const auto descriptor = over(std::make_shared<LowerDescriptor>(log), own);
  const std::unique_ptr<rtps::TransportInterface> transport{descriptor->create_transport()};
  rtps::SendResourceList resources;
  Locator loopback = own;
  IpLocator::setIPv4(loopback, "127.0.0.1");
  EXPECT_FALSE(transport->OpenOutputChannel(resources, own));
  EXPECT_FALSE(transport->OpenOutputChannel(resources, loopback)) << "the same host";
  EXPECT_TRUE(transport->OpenOutputChannel(resources, with_port(loopback, 5101)));
  EXPECT_TRUE(transport->OpenOutputChannel(resources, with_port(at(kLogicalPort, 2), 5100)));
  EXPECT_THAT(log.entries(), ElementsAre("begins", "connects to 127.0.0.1:5101", "connects to 192.0.2.2:5100"));
}

/// Which of three gaps are passed on: a true one, one that no test has, and another true one.
std::vector<std::string> passed_on(const rtps::TransportDescriptorInterface& descriptor, const LowerDescriptor& lower) {
  class Names final : public rtps::TransportReceiverInterface {
   public:
    explicit Names(Log& log) : log_{log} {}
    void OnDataReceived(const unsigned char* bytes, std::uint32_t count, const Locator&, const Locator&) override {
      const std::vector<std::uint8_t> packet{bytes, bytes + count};
      log_.add(packet == gap_up_to(5) ? "true gap" : packet == gap_up_to(std::uint64_t{1} << 60U) ? "harm" : "other");
    }

   private:
    Log& log_;
  };
  Names receiver{*lower.log};
  const std::unique_ptr<rtps::TransportInterface> transport{descriptor.create_transport()};
  EXPECT_TRUE(transport->OpenInputChannel(at(kLogicalPort, 1), &receiver, 1500));
  for (const std::uint64_t end : {std::uint64_t{5}, std::uint64_t{1} << 60U, std::uint64_t{5}}) {
    const std::vector<std::uint8_t> packet = gap_up_to(end);
    lower.receiver->OnDataReceived(packet.data(), static_cast<std::uint32_t>(packet.size()), {}, {});
  }
  EXPECT_TRUE(transport->CloseInputChannel(at(kLogicalPort, 1)));
  return lower.log->entries();
}

TEST(TcpTransport, PassesOnWhatThePacketFilterAdmits) {
  Log log;
  const auto lower = std::make_shared<LowerDescriptor>(log);
  const auto refused = std::make_shared<RefusedPackets>();
  const auto descriptor = tcp_transport(lower, std::nullopt, Admission::plain, refused, Duration{1});
  EXPECT_THAT(passed_on(*descriptor, *lower), ElementsAre("opens 7410", "begins", "true gap", "true gap"));
  EXPECT_EQ(refused->harmful, 1U);
  EXPECT_EQ(refused->in_plain_text, 0U);
}

TEST(TcpTransport, WithCredentialsItPassesOnNoPlainText) {
  Log log;
  const auto lower = std::make_shared<LowerDescriptor>(log);
  const auto refused = std::make_shared<RefusedPackets>();
  const auto descriptor = tcp_transport(lower, std::nullopt, Admission::secured, refused, Duration{1});
  EXPECT_THAT(passed_on(*descriptor, *lower), ElementsAre("opens 7410", "begins"));
  EXPECT_EQ(refused->harmful, 1U);
  EXPECT_EQ(refused->in_plain_text, 2U);
}

/// Control: TCP of Fast DDS passes on everything.
TEST(TcpTransport, WithoutItEverythingIsPassedOn) {
  Log log;
  const LowerDescriptor lower{log};
  EXPECT_THAT(passed_on(lower, lower), ElementsAre("opens 7410", "true gap", "harm", "true gap", "closes 7410"));
}

}  // namespace
}  // namespace hybridtest::fast_dds
