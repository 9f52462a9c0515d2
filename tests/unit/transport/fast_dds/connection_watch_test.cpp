#include "transport/fast_dds/connection_watch.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <vector>

namespace hybridtest::fast_dds {
namespace {

using std::chrono::milliseconds;

// Longer than a busy machine keeps a thread waiting: nothing is said meanwhile.
constexpr milliseconds kPatience{500};
constexpr int kLong_ms = 20'000;

/// Accepts connections on a port of this host, as a participant does that others connect to.
class Acceptor {
 public:
  Acceptor() : socket_{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)} {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof own;
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&own), size), 0);
    EXPECT_EQ(::listen(socket_, 4), 0);
    EXPECT_EQ(::getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size), 0);
    address_ = own;
  }
  ~Acceptor() {
    for (const int accepted : accepted_) ::close(accepted);
    ::close(socket_);
  }
  Acceptor(const Acceptor&) = delete;
  Acceptor& operator=(const Acceptor&) = delete;

  /// Sends something through each connection that was made.
  void speak() {
    for (int accepted = 0; (accepted = ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC)) >= 0;) {
      accepted_.push_back(accepted);
    }
    for (const int accepted : accepted_) EXPECT_EQ(::send(accepted, "RTCP", 4, MSG_NOSIGNAL), 4);
  }
  [[nodiscard]] const sockaddr_in& address() const { return address_; }
  [[nodiscard]] Locator locator() const {
    Locator locator;
    locator.kind = LOCATOR_KIND_TCPv4;
    IpLocator::setIPv4(locator, 127, 0, 0, 1);
    IpLocator::setPhysicalPort(locator, ntohs(address_.sin_port));
    return locator;
  }

 private:
  int socket_;
  std::vector<int> accepted_;
  sockaddr_in address_{};
};

class Connection {
 public:
  explicit Connection(const Acceptor& to) : socket_{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)} {
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&to.address()), sizeof(sockaddr_in)), 0);
  }
  ~Connection() { ::close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Whoever reads it is told so.
  [[nodiscard]] bool is_cut(int within_ms) const {
    pollfd ended{.fd = socket_, .events = 0, .revents = 0};
    return ::poll(&ended, 1, within_ms) == 1 && (ended.revents & POLLHUP) != 0;
  }

 private:
  int socket_;
};

TEST(ConnectionWatch, CutsANewConnectionThatStaysSilent) {
  Acceptor silent;
  Acceptor speaking;
  Acceptor unknown;
  ConnectionWatch watch{kPatience};
  const Connection before{silent};
  watch.expect(silent.locator());
  watch.expect(speaking.locator());
  const Connection to_speaking{speaking};
  const Connection to_unknown{unknown};
  const Connection to_silent{silent};
  silent.speak();  // the answer to its request, and no more
  while (!to_silent.is_cut(1)) speaking.speak();
  EXPECT_FALSE(to_speaking.is_cut(0));
  EXPECT_FALSE(to_unknown.is_cut(0));
  EXPECT_FALSE(before.is_cut(0)) << "of somebody else";

  // What has spoken once may be silent. A later connection is new.
  const Connection to_silent_again{silent};
  ASSERT_TRUE(to_silent_again.is_cut(kLong_ms));
  const Connection to_speaking_again{speaking};
  ASSERT_TRUE(to_speaking_again.is_cut(kLong_ms));
  EXPECT_FALSE(to_speaking.is_cut(0));
  EXPECT_FALSE(before.is_cut(0));
}

}  // namespace
}  // namespace hybridtest::fast_dds
