#pragma once

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <span>
#include <thread>
#include <vector>

namespace hybridtest {

/// A linear spring of one degree of freedom behind a blocking TCP socket, which notes what OpenSees says. It shares no
/// code with the server that it stands beside.
class BareServer {
 public:
  struct Message {
    int action = 0;
    double displacement_m = 0.0;  // of a trial
  };

  /// @param acknowledges_at_once   otherwise the system delays its acknowledgements by 40 ms.
  explicit BareServer(double stiffness_n_per_m, bool acknowledges_at_once = true)
      : stiffness_n_per_m_{stiffness_n_per_m},
        acknowledges_at_once_{acknowledges_at_once},
        listener_{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)} {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof own;
    // A client that does not come, or stops, ends the thread.
    const timeval patience{10, 0};
    ::setsockopt(listener_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    ::bind(listener_, reinterpret_cast<const sockaddr*>(&own), size);
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&own), &size);
    ::listen(listener_, 1);
    port_ = ntohs(own.sin_port);
    thread_ = std::thread{[this, patience] { serve(patience); }};
  }
  ~BareServer() {
    if (thread_.joinable()) thread_.join();
    ::close(listener_);
  }
  BareServer(const BareServer&) = delete;
  BareServer& operator=(const BareServer&) = delete;

  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
  /// Waits for the end of the client.
  [[nodiscard]] const std::vector<Message>& heard() {
    thread_.join();
    return heard_;
  }

 private:
  void serve(const timeval& patience) {
    const int client = ::accept(listener_, nullptr, nullptr);
    ::setsockopt(client, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    std::array<std::int32_t, 11> sizes{};
    if (receive(client, std::as_writable_bytes(std::span{sizes}))) {
      std::vector<double> values(static_cast<std::size_t>(sizes[10]));
      while (receive(client, std::as_writable_bytes(std::span{values}))) answer(client, values);
    }
    ::close(client);
  }
  void answer(int client, const std::vector<double>& values) {
    const Message message{static_cast<int>(values[0]), values[1]};
    heard_.push_back(message);
    if (message.action == 3) displacement_m_ = message.displacement_m;
    if (message.action < 10 || message.action == 99) return;
    std::vector<double> reply(values.size(), 0.0);
    if (message.action == 10) reply[0] = stiffness_n_per_m_ * displacement_m_;
    if (message.action == 12 || message.action == 13) reply[0] = stiffness_n_per_m_;
    static_cast<void>(::send(client, reply.data(), reply.size() * sizeof(double), MSG_NOSIGNAL));
  }
  [[nodiscard]] bool receive(int client, std::span<std::byte> bytes) {
    while (!bytes.empty()) {
      const auto count = ::recv(client, bytes.data(), bytes.size(), 0);
      if (count <= 0) return false;
      const int on = 1;
      if (acknowledges_at_once_) ::setsockopt(client, IPPROTO_TCP, TCP_QUICKACK, &on, sizeof on);
      bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
    return true;
  }

  double stiffness_n_per_m_;
  bool acknowledges_at_once_;
  int listener_;
  std::uint16_t port_ = 0;
  double displacement_m_ = 0.0;
  std::vector<Message> heard_;
  std::thread thread_;
};

}  // namespace hybridtest
