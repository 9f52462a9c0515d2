#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "transport/fast_dds/fast_dds_settings.hpp"

namespace hybridtest {

/// How the participants of a test reach each other.
enum class NetworkType : std::uint8_t { one_host, multicast, peers, discovery_server, tcp };

/// Ports, first and last included.
struct PortRange {
  std::uint16_t first = 0;
  std::uint16_t last = 0;
  bool operator==(const PortRange&) const = default;
};

/// Where one participant is.
struct NetworkHost {
  std::string participant;           // its id in the scenario, or `operator` for tools
  std::string host;                  // name or IPv4 address under which the others reach it; may be empty over TCP
  std::optional<PortRange> listens;  // UDP: ports for all that runs on the host. TCP: one port, none behind a firewall
  std::optional<std::string> interface_address;
};

/// A network profile: one file for all hosts of a test, which says who listens where. See `docs/across_hosts.md`.
struct NetworkProfile {
  NetworkType type = NetworkType::one_host;
  std::uint32_t domain = 0;
  std::vector<NetworkHost> hosts;
  NetworkHost server;  // with a discovery server
  std::optional<fast_dds::TlsFiles> tls;

  [[nodiscard]] const NetworkHost* find(std::string_view participant) const noexcept;
};

/// The UDP ports of the first `participants` participants of a host (RTPS 2.2, 9.6.1.1: two for each).
[[nodiscard]] PortRange udp_ports(std::uint32_t domain, int participants);

/// @throws ConfigError with every error of the file.
[[nodiscard]] NetworkProfile read_network_profile(const std::filesystem::path& file);

/// The same in another DDS domain, which moves the UDP ports.
void move_to_domain(NetworkProfile& profile, std::uint32_t domain);

/// What one participant makes of the profile.
/// @param participant   its id; `operator` for a tool, which needs no entry.
/// @throws ConfigError for a participant that the profile must name and does not.
[[nodiscard]] fast_dds::FastDdsSettings settings_of(const NetworkProfile& profile, std::string_view participant);

}  // namespace hybridtest
