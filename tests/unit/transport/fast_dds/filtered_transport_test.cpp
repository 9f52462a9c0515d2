#include "transport/fast_dds/filtered_transport.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <vector>

#include "tests/support/rtps_packets.hpp"
#include "tests/unit/transport/fast_dds/loopback_udp.hpp"

namespace hybridtest::fast_dds {
namespace {

using ::testing::ElementsAre;
using Packet = std::vector<std::uint8_t>;

class Collector final : public rtps::TransportReceiverInterface {
 public:
  void OnDataReceived(const unsigned char* bytes, std::uint32_t count, const Locator&, const Locator&) override {
    const std::lock_guard lock{mutex_};
    packets_.emplace_back(bytes, bytes + count);
    changed_.notify_all();
  }
  /// @return what came up to this packet; all of it when it does not come.
  std::vector<Packet> up_to(const Packet& last) {
    std::unique_lock lock{mutex_};
    changed_.wait_for(lock, std::chrono::seconds{20}, [&] { return !packets_.empty() && packets_.back() == last; });
    return packets_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Packet> packets_;
};

const Packet kHarmful = gap_up_to(std::uint64_t{1} << 60U);
const Packet kHarmless = gap_up_to(5);

/// Of one that no test has and one that is like any other, what Fast DDS gets over this transport.
std::vector<Packet> received(const rtps::TransportDescriptorInterface& descriptor) {
  Collector receiver;
  const std::unique_ptr<rtps::TransportInterface> transport{descriptor.create_transport()};
  EXPECT_TRUE(transport->init());
  const std::uint16_t port = free_port();
  EXPECT_TRUE(transport->OpenInputChannel(loopback_at(port), &receiver, 1500));
  EXPECT_TRUE(send_to(port, kHarmful));
  EXPECT_TRUE(send_to(port, kHarmless));
  std::vector<Packet> packets = receiver.up_to(kHarmless);
  EXPECT_TRUE(transport->CloseInputChannel(loopback_at(port)));
  transport->shutdown();
  return packets;
}

TEST(FilteredTransport, PassesOnWhatThePacketFilterAdmits) {
  const auto refused = std::make_shared<RefusedPackets>();
  EXPECT_THAT(received(*filtered_transport(loopback_udp(), Admission::plain, refused)), ElementsAre(kHarmless));
  EXPECT_EQ(refused->harmful, 1U);
}

/// Control: without it, Fast DDS gets both.
TEST(FilteredTransport, UdpOfFastDdsPassesOnEverything) {
  EXPECT_THAT(received(*loopback_udp()), ElementsAre(kHarmful, kHarmless));
}

}  // namespace
}  // namespace hybridtest::fast_dds
