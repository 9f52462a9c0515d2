#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace hybridtest::fast_dds {

/// A Fast DDS discovery server with the id 0: participants of any test find each other through it, without multicast
/// and without knowing each other's addresses. Messages do not pass through it.
class DiscoveryServer {
 public:
  /// Serves until it is destroyed.
  /// @param interface_address   IPv4 address to listen at; otherwise every interface.
  /// @throws ConfigError for an address that this host does not have.
  /// @throws std::runtime_error when the port is taken.
  explicit DiscoveryServer(std::uint16_t port, const std::optional<std::string>& interface_address = {});
  ~DiscoveryServer();
  DiscoveryServer(const DiscoveryServer&) = delete;
  DiscoveryServer& operator=(const DiscoveryServer&) = delete;

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace hybridtest::fast_dds
