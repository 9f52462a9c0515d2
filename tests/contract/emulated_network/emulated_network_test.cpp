#include "tests/support/emulated_network.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>
#include <iostream>
#include <numeric>
#include <set>
#include <string>

/// The emulated network against what was asked of it, seen through sockets of the hosts.
namespace hybridtest {
namespace {

using std::chrono::milliseconds;

constexpr std::uint16_t kPort = 5000;
constexpr const char* kGroup = "239.255.0.1";

sockaddr_in at(const std::string& address) {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  result.sin_port = htons(kPort);
  ::inet_pton(AF_INET, address.c_str(), &result.sin_addr);
  return result;
}

/// A UDP socket of a host, at kPort of every address.
OwnedFile socket_in(const EmulatedHost& host) {
  OwnedFile socket;
  host.inside([&] {
    socket = OwnedFile{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
    const int room = 1 << 23U;
    ::setsockopt(socket.get(), SOL_SOCKET, SO_RCVBUFFORCE, &room, sizeof room);
    const sockaddr_in any = at("0.0.0.0");
    ASSERT_EQ(::bind(socket.get(), reinterpret_cast<const sockaddr*>(&any), sizeof any), 0);
    ip_mreqn membership{};
    ::inet_pton(AF_INET, kGroup, &membership.imr_multiaddr);
    ::inet_pton(AF_INET, host.address().c_str(), &membership.imr_address);
    ASSERT_EQ(::setsockopt(socket.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership), 0);
  });
  return socket;
}

void send_number(const OwnedFile& socket, const std::string& address, std::uint32_t number) {
  const sockaddr_in to = at(address);
  ASSERT_EQ(::sendto(socket.get(), &number, sizeof number, 0, reinterpret_cast<const sockaddr*>(&to), sizeof to),
            static_cast<ssize_t>(sizeof number));
}

/// @return nothing when none comes within the patience.
std::optional<std::uint32_t> next_number(const OwnedFile& socket, milliseconds patience) {
  pollfd file{.fd = socket.get(), .events = POLLIN, .revents = 0};
  if (::poll(&file, 1, static_cast<int>(patience.count())) <= 0) return {};
  std::uint32_t number = 0;
  EXPECT_EQ(::recv(socket.get(), &number, sizeof number, 0), static_cast<ssize_t>(sizeof number));
  return number;
}

/// Standard deviation of the share of `count` independent draws.
double deviation(double share, int count) { return std::sqrt(share * (1.0 - share) / count); }

class EmulatedNetworkTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const std::string why = EmulatedHost::why_not(); !why.empty()) GTEST_SKIP() << why;
    build(false);
  }

  void build(bool has_multicast) {
    network_.reset();
    std::vector<EmulatedHost> hosts;
    for (int number = 1; number <= 3; ++number) hosts.emplace_back(number);
    network_ = std::make_unique<EmulatedNetwork>(std::move(hosts), 1, has_multicast);
    sockets_.clear();
    for (std::size_t i = 0; i < 3; ++i) sockets_.push_back(socket_in(network_->host(i)));
  }

  /// Numbers from 0 from the first host to the second one, as they arrive.
  [[nodiscard]] std::vector<std::uint32_t> send_through(int count) {
    std::vector<std::uint32_t> arrived;
    for (int i = 0; i < count; ++i)
      send_number(sockets_[0], network_->host(1).address(), static_cast<std::uint32_t>(i));
    while (const auto number = next_number(sockets_[1], milliseconds{300})) arrived.push_back(*number);
    return arrived;
  }

  std::unique_ptr<EmulatedNetwork> network_;
  std::vector<OwnedFile> sockets_;
};

TEST_F(EmulatedNetworkTest, RoundTripIsTwiceTheDelay) {
  LinkConditions conditions;
  conditions.delay = milliseconds{20};
  network_->set_all(conditions);
  std::vector<double> round_trip_ms;
  for (std::uint32_t i = 0; i < 30; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    send_number(sockets_[0], network_->host(1).address(), i);
    ASSERT_EQ(next_number(sockets_[1], milliseconds{5000}), i);
    send_number(sockets_[1], network_->host(0).address(), i);
    ASSERT_EQ(next_number(sockets_[0], milliseconds{5000}), i);
    round_trip_ms.push_back(1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  std::ranges::sort(round_trip_ms);
  std::cout << "round trip over 2 x 20 ms: " << round_trip_ms.front() << " ms at least, " << round_trip_ms[15]
            << " ms in the middle\n";
  EXPECT_GE(round_trip_ms.front(), 40.0);
  EXPECT_LE(round_trip_ms.front(), 50.0);  // a busy machine delays some, not all
}

TEST_F(EmulatedNetworkTest, LosesTheShareThatWasAsked) {
  constexpr int kCount = 5000;
  for (const double loss : {0.01, 0.2}) {
    LinkConditions conditions;
    conditions.loss = loss;
    network_->set(0, 1, conditions);
    const double measured = 1.0 - static_cast<double>(send_through(kCount).size()) / kCount;
    std::cout << "loss " << loss << " asked, " << measured << " measured\n";
    EXPECT_NEAR(measured, loss, 4.0 * deviation(loss, kCount));
  }
  EXPECT_EQ(network_->counters(0, 1).taken, 2U * kCount);
}

TEST_F(EmulatedNetworkTest, BurstsAreAsLongAsAsked) {
  constexpr int kCount = 20'000;
  LinkConditions conditions;
  conditions.bursts = {.to_bad = 0.01, .to_good = 0.2};
  network_->set(0, 1, conditions);
  const std::vector<std::uint32_t> arrived = send_through(kCount);
  int bursts = 0;
  int lost = 0;
  for (std::size_t i = 1; i < arrived.size(); ++i) {
    const int gap = static_cast<int>(arrived[i] - arrived[i - 1]) - 1;
    bursts += gap > 0 ? 1 : 0;
    lost += gap;
  }
  ASSERT_GT(bursts, 0);
  const double mean = static_cast<double>(lost) / bursts;
  std::cout << "bursts of 5 packets asked, " << mean << " measured; share lost 0.0476 asked, "
            << static_cast<double>(lost) / kCount << " measured\n";
  // A burst is geometric: its variance is (1 - r) / r^2. Of the share lost, the states of packets are correlated.
  EXPECT_NEAR(mean, 5.0, 4.0 * std::sqrt(20.0 / bursts));
  EXPECT_NEAR(static_cast<double>(lost) / kCount, 0.01 / 0.21, 4.0 * std::sqrt(9.0) * deviation(0.01 / 0.21, kCount));
}

TEST_F(EmulatedNetworkTest, DoublesTheShareThatWasAsked) {
  constexpr int kCount = 5000;
  LinkConditions conditions;
  conditions.duplication = 0.1;
  network_->set(0, 1, conditions);
  const std::vector<std::uint32_t> arrived = send_through(kCount);
  const std::set<std::uint32_t> different(arrived.begin(), arrived.end());
  EXPECT_EQ(different.size(), static_cast<std::size_t>(kCount));
  EXPECT_NEAR(static_cast<double>(arrived.size() - different.size()) / kCount, 0.1, 4.0 * deviation(0.1, kCount));
}

TEST_F(EmulatedNetworkTest, ReordersAndOtherwiseKeepsTheOrder) {
  LinkConditions conditions;
  conditions.jitter = milliseconds{5};
  network_->set(0, 1, conditions);
  std::vector<std::uint32_t> arrived = send_through(2000);
  EXPECT_EQ(arrived.size(), 2000U);
  EXPECT_TRUE(std::ranges::is_sorted(arrived));

  conditions.reordering = 0.05;
  conditions.reordered_by = milliseconds{10};
  network_->set(0, 1, conditions);
  arrived = send_through(2000);
  EXPECT_FALSE(std::ranges::is_sorted(arrived));
  std::ranges::sort(arrived);
  std::vector<std::uint32_t> sent(2000);
  std::iota(sent.begin(), sent.end(), 0U);
  EXPECT_EQ(arrived, sent);
}

TEST_F(EmulatedNetworkTest, LimitedRateTakesItsTime) {
  constexpr int kCount = 500;
  constexpr double kPacketBits = 8.0 * (4 + 28);  // UDP and IPv4 headers
  LinkConditions conditions;
  conditions.rate_bit_per_s = 1e6;
  conditions.queue_most = std::chrono::seconds{10};
  network_->set(0, 1, conditions);
  const auto begin = std::chrono::steady_clock::now();
  for (std::uint32_t i = 0; i < kCount; ++i) send_number(sockets_[0], network_->host(1).address(), i);
  for (std::uint32_t i = 0; i < kCount; ++i) ASSERT_EQ(next_number(sockets_[1], milliseconds{5000}), i);
  const double taken_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_GE(taken_s, kCount * kPacketBits / 1e6);

  conditions.queue_most = milliseconds{10};
  network_->set(0, 1, conditions);
  EXPECT_LT(send_through(kCount).size(), static_cast<std::size_t>(kCount));
  EXPECT_GT(network_->counters(0, 1).overflowed, 0U);
}

TEST_F(EmulatedNetworkTest, CutHostHearsNothingUntilItIsBack) {
  network_->cut(1, true);
  EXPECT_TRUE(send_through(10).empty());
  EXPECT_EQ(network_->counters(0, 1).cut, 10U);
  network_->cut(1, false);
  EXPECT_EQ(send_through(10).size(), 10U);
}

TEST_F(EmulatedNetworkTest, MulticastReachesAllOthersOrNone) {
  send_number(sockets_[0], kGroup, 7);
  EXPECT_FALSE(next_number(sockets_[1], milliseconds{200}));
  build(true);
  send_number(sockets_[0], kGroup, 7);
  EXPECT_EQ(next_number(sockets_[1], milliseconds{5000}), 7U);
  EXPECT_EQ(next_number(sockets_[2], milliseconds{5000}), 7U);
}

TEST_F(EmulatedNetworkTest, TcpArrivesCompleteThroughLoss) {
  LinkConditions conditions;
  conditions.delay = milliseconds{2};
  conditions.loss = 0.02;
  conditions.duplication = 0.02;
  network_->set_all(conditions);
  std::vector<std::uint32_t> sent(65'536);
  std::iota(sent.begin(), sent.end(), 0U);
  const std::size_t bytes = sent.size() * sizeof(std::uint32_t);

  OwnedFile listener;
  network_->host(1).inside([&] {
    listener = OwnedFile{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
    const sockaddr_in any = at("0.0.0.0");
    ASSERT_EQ(::bind(listener.get(), reinterpret_cast<const sockaddr*>(&any), sizeof any), 0);
    ASSERT_EQ(::listen(listener.get(), 1), 0);
  });
  std::thread sender{[&] {
    network_->host(0).inside([&] {
      const OwnedFile socket{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
      const sockaddr_in to = at(network_->host(1).address());
      ASSERT_EQ(::connect(socket.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
      ASSERT_EQ(::send(socket.get(), sent.data(), bytes, 0), static_cast<ssize_t>(bytes));
    });
  }};
  const OwnedFile connection{::accept(listener.get(), nullptr, nullptr)};
  std::vector<std::uint32_t> arrived(sent.size());
  EXPECT_EQ(::recv(connection.get(), arrived.data(), bytes, MSG_WAITALL), static_cast<ssize_t>(bytes));
  sender.join();
  EXPECT_EQ(arrived, sent);
  EXPECT_GT(network_->counters().lost, 0U);
}

TEST_F(EmulatedNetworkTest, SeedRepeatsWhichPacketsAreLost) {
  LinkConditions conditions;
  conditions.loss = 0.1;
  network_->set(0, 1, conditions);
  const std::vector<std::uint32_t> first = send_through(1000);
  build(false);
  network_->set(0, 1, conditions);
  EXPECT_EQ(send_through(1000), first);
}

TEST_F(EmulatedNetworkTest, ProgramsOfAHostHaveItsClock) {
  const EmulatedHost ahead{9, std::chrono::seconds{5000}};
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const OwnedFile reading{ends[0]};
  const OwnedFile writing{ends[1]};
  // The time since the start of the machine, as a program of somebody else tells it.
  try {
    ahead.inside([&] {
      if (::fork() == 0) {
        ::dup2(writing.get(), STDOUT_FILENO);
        ::execlp("awk", "awk", "{print $1}", "/proc/uptime", nullptr);
        ::_exit(127);
      }
    });
  } catch (const std::exception& error) {
    GTEST_SKIP() << "clocks of hosts cannot be set here: " << error.what();
  }
  timespec here{};
  ::clock_gettime(CLOCK_BOOTTIME, &here);
  std::array<char, 64> text{};
  ASSERT_GT(::read(reading.get(), text.data(), text.size() - 1), 0);
  EXPECT_NEAR(std::stod(text.data()), static_cast<double>(here.tv_sec) + 5000.0, 60.0);
}

}  // namespace
}  // namespace hybridtest
