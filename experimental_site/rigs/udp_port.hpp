#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "experimental_site/rigs/datagram_port.hpp"

namespace hybridtest {

/// A UDP socket that sends to one address and receives from no other.
class UdpPort final : public DatagramPort {
 public:
  struct Address {
    std::string host;              // name or number, IPv4 or IPv6
    std::uint16_t port = 0;        // of the peer
    std::uint16_t local_port = 0;  // 0: any free port
  };

  explicit UdpPort(Address address) : address_{std::move(address)} {}
  ~UdpPort() override;
  UdpPort(const UdpPort&) = delete;
  UdpPort& operator=(const UdpPort&) = delete;

  void open() override;
  bool send(std::span<const std::byte> datagram) noexcept override;
  /// An unreachable port, as the network may report it, counts as no datagram.
  [[nodiscard]] std::optional<std::size_t> receive(std::span<std::byte> buffer, Duration& patience) noexcept override;

 private:
  void close() noexcept;

  Address address_;
  std::atomic<int> socket_{-1};  // send() may come from any thread
};

}  // namespace hybridtest
