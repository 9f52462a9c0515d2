#include "transport/fast_dds/polled_socket.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <string>
#include <string_view>
#include <thread>

#include "tests/support/signals_in_turn.hpp"
#include "transport/waker.hpp"

namespace hybridtest::fast_dds {
namespace {

using Clock = std::chrono::steady_clock;
constexpr Clock::time_point kEndless = Clock::time_point::max();
constexpr std::uint32_t kBytesMax = 1500;

/// A peer that sends from a socket of its own.
class Sender {
 public:
  Sender() : socket_{::socket(AF_INET, SOCK_DGRAM, 0)} {
    sockaddr_in address = to(0);
    socklen_t size = sizeof(address);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
  }
  ~Sender() { ::close(socket_); }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  void send(std::uint16_t port, std::string_view text) const {
    const sockaddr_in address = to(port);
    EXPECT_EQ(
        ::sendto(socket_, text.data(), text.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof(address)),
        static_cast<ssize_t>(text.size()));
  }
  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  static sockaddr_in to(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
  }

  int socket_;
  std::uint16_t port_ = 0;
};

/// The first port that is free. @return 0 when none is.
std::uint16_t open_somewhere(PolledSocket& socket, const PolledSocket::Sink& sink) {
  for (std::uint16_t port = 29000; port < 29100; ++port) {
    if (socket.open(port, true, kBytesMax, sink)) return port;
  }
  return 0;
}

TEST(PolledSocket, ThreadThatWaitsReceivesItself) {
  PolledSocket socket{Duration{0}};
  Waker waker{&socket};
  std::string text;
  std::thread::id thread;
  std::uint32_t from = 0;
  std::uint16_t from_port = 0;
  const std::uint16_t port = open_somewhere(
      socket, [&](const std::uint8_t* bytes, std::uint32_t count, std::uint32_t address, std::uint16_t its_port) {
        text.assign(bytes, bytes + count);
        thread = std::this_thread::get_id();
        from = address;
        from_port = its_port;
        waker.signal();
      });
  ASSERT_NE(port, 0);
  const Sender sender;
  // Until the other thread has seen that it is not needed.
  while (thread != std::this_thread::get_id()) {
    sender.send(port, "step 7");
    EXPECT_TRUE(waker.wait_until(kEndless));
  }
  EXPECT_EQ(text, "step 7");
  EXPECT_EQ(from, INADDR_LOOPBACK);
  EXPECT_EQ(from_port, sender.port());
}

TEST(PolledSocket, AnotherThreadStandsInWhileNobodyWaits) {
  PolledSocket socket{Duration{0}};
  std::atomic<bool> arrived{false};
  std::thread::id thread;
  const std::uint16_t port =
      open_somewhere(socket, [&](const std::uint8_t*, std::uint32_t, std::uint32_t, std::uint16_t) {
        thread = std::this_thread::get_id();
        arrived = true;
        arrived.notify_one();
      });
  ASSERT_NE(port, 0);
  const Sender sender;
  sender.send(port, "hello");
  arrived.wait(false);
  EXPECT_NE(thread, std::this_thread::get_id());
}

TEST(PolledSocket, StandsInAgainWhenTheWaitingThreadIsAway) {
  PolledSocket socket{Duration{0}};
  Waker waker{&socket};
  std::atomic<int> arrived{0};
  const std::uint16_t port =
      open_somewhere(socket, [&](const std::uint8_t*, std::uint32_t, std::uint32_t, std::uint16_t) {
        ++arrived;
        arrived.notify_one();
        waker.signal();
      });
  ASSERT_NE(port, 0);
  const Sender sender;
  sender.send(port, "first");
  ASSERT_TRUE(waker.wait_until(kEndless));
  sender.send(port, "while it computes");
  arrived.wait(1);
  EXPECT_EQ(arrived, 2);
}

/// Otherwise it reads a message between two waits, later than the instant that the node works with.
TEST(PolledSocket, StandsInNoMoreOnceTheWaitingThreadIsBack) {
  for (const bool was_signalled : {false, true}) {
    PolledSocket socket{Duration{0}};
    Waker waker{&socket};
    std::atomic<int> arrived{0};
    std::atomic<Clock::time_point> at{};
    const std::uint16_t port =
        open_somewhere(socket, [&](const std::uint8_t*, std::uint32_t, std::uint32_t, std::uint16_t) {
          at = Clock::now();
          ++arrived;
          arrived.notify_one();
        });
    ASSERT_NE(port, 0);
    const Sender sender;
    sender.send(port, "while it computes");
    arrived.wait(0);
    if (was_signalled) waker.signal();
    const Clock::time_point back = Clock::now();
    EXPECT_EQ(waker.wait_until(Clock::time_point{}), was_signalled);
    sender.send(port, "after its wait");
    arrived.wait(1);
    EXPECT_GE(at.load() - back, PolledSocket::kAbsence) << "a wait that was signalled before: " << was_signalled;
  }
}

TEST(PolledSocket, WaitWithPastDeadlineReceives) {
  PolledSocket socket{Duration{0}};
  Waker waker{&socket};
  std::atomic<int> arrived{0};
  const std::uint16_t port =
      open_somewhere(socket, [&](const std::uint8_t*, std::uint32_t, std::uint32_t, std::uint16_t) {
        ++arrived;
        waker.signal();
      });
  ASSERT_NE(port, 0);
  const Sender sender;
  sender.send(port, "1");
  EXPECT_TRUE(waker.wait_until(Clock::time_point{}));
  sender.send(port, "2");
  waker.signal();  // pending already
  EXPECT_TRUE(waker.wait_until(kEndless));
  EXPECT_EQ(arrived, 2);
  EXPECT_FALSE(waker.wait_until(Clock::time_point{})) << "used up";
}

TEST(PolledSocket, BusyPollReceivesAndEndsAtTheDeadline) {
  PolledSocket socket{std::chrono::seconds{1}};
  Waker waker{&socket};
  const std::uint16_t port =
      open_somewhere(socket, [&](const std::uint8_t*, std::uint32_t, std::uint32_t, std::uint16_t) { waker.signal(); });
  ASSERT_NE(port, 0);
  const Clock::time_point deadline = Clock::now() + std::chrono::milliseconds{5};
  EXPECT_FALSE(waker.wait_until(deadline));
  EXPECT_GE(Clock::now(), deadline);
  const Sender sender;
  sender.send(port, "1");
  EXPECT_TRUE(waker.wait_until(kEndless));
}

TEST(PolledSocket, DeadlineEndsWait) {
  PolledSocket socket{Duration{0}};
  Waker waker{&socket};
  const Clock::time_point deadline = Clock::now() + std::chrono::milliseconds{20};
  EXPECT_FALSE(waker.wait_until(deadline));
  EXPECT_GE(Clock::now(), deadline);
}

TEST(PolledSocket, LosesNoSignalBetweenTwoThreads) {
  PolledSocket first{Duration{0}};
  PolledSocket second{Duration{0}};
  Waker ping{&first};
  Waker pong{&second};
  expect_signals_in_turn(ping, pong, 5000, [](Waker& waker) { return waker.wait_until(kEndless); });
}

TEST(PolledSocket, TakenPortIsRefused) {
  PolledSocket first{Duration{0}};
  PolledSocket second{Duration{0}};
  const auto ignore = [](const std::uint8_t*, std::uint32_t, std::uint32_t, std::uint16_t) {};
  const std::uint16_t port = open_somewhere(first, ignore);
  ASSERT_NE(port, 0);
  EXPECT_TRUE(first.is_open_at(port));
  EXPECT_FALSE(second.open(port, true, kBytesMax, ignore));
  EXPECT_FALSE(second.is_open_at(port));
}

TEST(PolledSocket, PassesNothingOnAfterClosing) {
  PolledSocket socket{Duration{0}};
  std::atomic<int> arrived{0};
  const std::uint16_t port =
      open_somewhere(socket, [&](const std::uint8_t*, std::uint32_t, std::uint32_t, std::uint16_t) { ++arrived; });
  ASSERT_NE(port, 0);
  socket.close();
  EXPECT_FALSE(socket.is_open_at(port));
  const Sender sender;
  sender.send(port, "late");
  socket.receive();
  EXPECT_EQ(arrived, 0);
}

}  // namespace
}  // namespace hybridtest::fast_dds
