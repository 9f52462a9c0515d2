#include "experimental_site/rigs/udp_port.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <stdexcept>
#include <vector>

/// Real sockets on this machine, at numbers that the system gave.
namespace hybridtest {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Receives from a sender that has certainly sent.
constexpr Duration kPatience = 10s;

std::uint16_t free_port() {
  const int probe = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  EXPECT_EQ(::bind(probe, reinterpret_cast<sockaddr*>(&address), size), 0);
  EXPECT_EQ(::getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size), 0);
  ::close(probe);
  return ntohs(address.sin_port);
}

std::vector<std::byte> datagram(std::size_t size, int value) {
  return std::vector<std::byte>(size, static_cast<std::byte>(value));
}

class UdpPorts : public testing::Test {
 protected:
  /// @return what was received, cut to the buffer; empty when nothing came.
  static std::vector<std::byte> received(UdpPort& port, Duration patience = kPatience) {
    std::array<std::byte, 16> buffer{};
    const auto size = port.receive(buffer, patience);
    if (!size) return {};
    return {buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(*size)};
  }

  std::uint16_t here_number_ = free_port();
  std::uint16_t there_number_ = free_port();
  UdpPort here_{{.host = "127.0.0.1", .port = there_number_, .local_port = here_number_}};
  UdpPort there_{{.host = "127.0.0.1", .port = here_number_, .local_port = there_number_}};
};

TEST_F(UdpPorts, CarryDatagramsInBothDirections) {
  here_.open();
  there_.open();
  ASSERT_TRUE(here_.send(datagram(3, 1)));
  ASSERT_TRUE(here_.send(datagram(5, 2)));
  EXPECT_EQ(received(there_), datagram(3, 1));
  EXPECT_EQ(received(there_), datagram(5, 2));
  ASSERT_TRUE(there_.send(datagram(7, 3)));
  EXPECT_EQ(received(here_), datagram(7, 3));
}

TEST_F(UdpPorts, ReceiveDoesNotWaitWithZeroTimeout) {
  here_.open();
  Duration patience{};
  std::array<std::byte, 16> buffer{};
  EXPECT_FALSE(here_.receive(buffer, patience));
}

TEST_F(UdpPorts, ReceiveWaitsFullTimeoutWithoutPeer) {
  here_.open();
  for (int i = 0; i < 3; ++i) here_.send(datagram(3, 1));  // each is answered by a refusal
  Duration patience = 5ms;
  std::array<std::byte, 16> buffer{};
  EXPECT_FALSE(here_.receive(buffer, patience));
  EXPECT_EQ(patience, 0ns);
}

TEST_F(UdpPorts, ReceiveReturnsAtOnceWhenADatagramWaits) {
  here_.open();
  there_.open();
  there_.send(datagram(3, 1));
  EXPECT_EQ(received(here_), datagram(3, 1));
  there_.send(datagram(3, 2));
  Duration patience = kPatience;
  std::array<std::byte, 16> buffer{};
  EXPECT_TRUE(here_.receive(buffer, patience));
  EXPECT_GT(patience, 0ns);
  EXPECT_LE(patience, kPatience);
}

TEST_F(UdpPorts, IgnoreOtherSenders) {
  here_.open();
  UdpPort stranger{{.host = "127.0.0.1", .port = here_number_}};
  stranger.open();
  stranger.send(datagram(3, 9));
  there_.open();
  there_.send(datagram(3, 1));
  EXPECT_EQ(received(here_), datagram(3, 1));
}

TEST_F(UdpPorts, DoNothingBeforeOpening) {
  EXPECT_FALSE(here_.send(datagram(3, 1)));
  EXPECT_TRUE(received(here_).empty());
}

TEST_F(UdpPorts, ReportWhyOpeningFailed) {
  UdpPort nowhere{{.host = "no.such.host.invalid", .port = 5000}};
  EXPECT_THAT([&] { nowhere.open(); }, ThrowsMessage<std::runtime_error>(HasSubstr("udp no.such.host.invalid:5000:")));
  here_.open();
  UdpPort same{{.host = "127.0.0.1", .port = there_number_, .local_port = here_number_}};
  EXPECT_THAT([&] { same.open(); }, ThrowsMessage<std::runtime_error>(HasSubstr("its local port cannot be used")));
}

}  // namespace
}  // namespace hybridtest
