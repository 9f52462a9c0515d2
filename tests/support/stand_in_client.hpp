#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "tests/support/generic_client_bytes.hpp"

namespace hybridtest {

/// An element genericClient of our own, over TCP or UDP on this machine, with the options of the real one: none.
class StandInClient {
 public:
  enum class Over : std::uint8_t { tcp, udp };

  /// @param from   own address; loopback has many.
  StandInClient(std::uint16_t port, Over over, const char* from = "127.0.0.1")
      : over_{over}, socket_{::socket(AF_INET, (over == Over::tcp ? SOCK_STREAM : SOCK_DGRAM) | SOCK_CLOEXEC, 0)} {
    sockaddr_in own = address(from, 0);
    sockaddr_in server = address("127.0.0.1", port);
    if (::bind(socket_, reinterpret_cast<sockaddr*>(&own), sizeof own) != 0 ||
        ::connect(socket_, reinterpret_cast<sockaddr*>(&server), sizeof server) != 0) {
      throw std::runtime_error{std::string{"no connection: "} + std::strerror(errno)};
    }
  }
  ~StandInClient() { close(); }
  StandInClient(const StandInClient&) = delete;
  StandInClient& operator=(const StandInClient&) = delete;

  void close() noexcept {
    if (socket_ >= 0) ::close(std::exchange(socket_, -1));
  }
  /// As when its process is killed with data on the way.
  void reset() noexcept {
    const linger now{1, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_LINGER, &now, sizeof now);
    close();
  }

  /// Over UDP a client asks for a byte first. @return whether it was given.
  [[nodiscard]] bool shakes_hands(int patience_ms = 10'000) {
    if (over_ == Over::tcp) return true;
    send_raw(generic_client::Bytes{std::byte{'a'}});
    const auto answer = receive(1, patience_ms);
    return answer && (*answer)[0] == std::byte{'b'};
  }
  /// Over UDP in datagrams as OpenSees makes them.
  void send(std::span<const std::byte> bytes) {
    constexpr std::size_t kDatagram = 9126;
    while (over_ == Over::udp && bytes.size() > kDatagram) {
      send_raw(bytes.first(kDatagram));
      bytes = bytes.subspan(kDatagram);
    }
    send_raw(bytes);
  }
  /// @return nothing when less came in time, or the connection closed.
  [[nodiscard]] std::optional<generic_client::Bytes> receive(std::size_t count, int patience_ms = 10'000) {
    generic_client::Bytes bytes(count);
    for (std::size_t at = 0; at < count;) {
      pollfd readable{socket_, POLLIN, 0};
      if (::poll(&readable, 1, patience_ms) != 1) return {};
      const auto received = ::recv(socket_, bytes.data() + at, count - at, 0);
      if (received <= 0) return {};
      at += static_cast<std::size_t>(received);
    }
    return bytes;
  }
  [[nodiscard]] std::optional<std::vector<double>> answer(int data_size = generic_client::kDataSize,
                                                          int patience_ms = 10'000) {
    const auto bytes = receive(static_cast<std::size_t>(data_size) * sizeof(double), patience_ms);
    if (!bytes) return {};
    return generic_client::doubles(*bytes);
  }
  /// The server closed the connection.
  [[nodiscard]] bool is_closed() {
    pollfd readable{socket_, POLLIN, 0};
    std::byte byte{};
    return ::poll(&readable, 1, 10'000) == 1 && ::recv(socket_, &byte, 1, 0) <= 0;
  }

 private:
  static sockaddr_in address(const char* host, std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    ::inet_pton(AF_INET, host, &address.sin_addr);
    return address;
  }
  void send_raw(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const auto sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent < 0) return;  // the test sees it by what is missing
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
    }
  }

  Over over_;
  int socket_;
};

}  // namespace hybridtest
