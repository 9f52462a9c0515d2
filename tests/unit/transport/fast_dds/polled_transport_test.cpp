#include "transport/fast_dds/polled_transport.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>

#include "core/time.hpp"
#include "tests/support/rtps_packets.hpp"
#include "tests/unit/transport/fast_dds/loopback_udp.hpp"

namespace hybridtest::fast_dds {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Counts how many threads are in it at a time.
class MeetingPoint final : public rtps::TransportReceiverInterface {
 public:
  /// @param patience   how long the first to come waits for a second one.
  explicit MeetingPoint(Duration patience) : patience_{patience} {}

  void OnDataReceived(const unsigned char*, std::uint32_t, const Locator&, const Locator&) override {
    std::unique_lock lock{mutex_};
    most_ = std::max(most_, ++inside_);
    changed_.notify_all();
    if (received_ == 0) changed_.wait_for(lock, patience_, [this] { return most_ > 1; });
    --inside_;
    ++received_;
    changed_.notify_all();
  }

  /// @return the most threads that were in it at one time, once so many packets were received.
  std::optional<int> most_at_once(int packets) {
    std::unique_lock lock{mutex_};
    if (!changed_.wait_for(lock, seconds{20}, [&] { return received_ >= packets; })) return std::nullopt;
    return most_;
  }

 private:
  const Duration patience_;
  std::mutex mutex_;
  std::condition_variable changed_;
  int inside_ = 0;
  int most_ = 0;
  int received_ = 0;
};

/// Two ports of one participant, a packet at each, taken in by one receiver.
std::optional<int> threads_at_once(const rtps::TransportDescriptorInterface& descriptor, Duration patience) {
  MeetingPoint receiver{patience};
  const std::unique_ptr<rtps::TransportInterface> transport{descriptor.create_transport()};
  EXPECT_TRUE(transport->init());
  const std::array ports{free_port(), free_port()};
  for (const std::uint16_t port : ports) {
    EXPECT_TRUE(transport->OpenInputChannel(loopback_at(port), &receiver, 1500));
  }
  for (const std::uint16_t port : ports) EXPECT_TRUE(send_to(port, {'R', 'T', 'P', 'S'}));
  const std::optional<int> most = receiver.most_at_once(2);
  for (const std::uint16_t port : ports) EXPECT_TRUE(transport->CloseInputChannel(loopback_at(port)));
  transport->shutdown();
  return most;
}

TEST(PolledTransport, TakesInOnePacketOfDiscoveryAtATime) {
  // Domain 232 has its ports of messages at the end, where the system gives out none.
  const auto descriptor = polled_transport(loopback_udp(), std::make_shared<PolledSocket>(Duration{0}), 232, true);
  EXPECT_EQ(threads_at_once(*descriptor, milliseconds{100}), 1);
}

/// Control: without it, two threads are in at once.
TEST(PolledTransport, UdpOfFastDdsTakesInTwoPacketsAtOnce) {
  EXPECT_EQ(threads_at_once(*loopback_udp(), seconds{10}), 2);
}

}  // namespace
}  // namespace hybridtest::fast_dds
