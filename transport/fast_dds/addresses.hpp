#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "transport/fast_dds/dds_version.hpp"

namespace hybridtest::fast_dds {

/// Where a discovery server listens unless another port is given, as `fastdds discovery` does.
inline constexpr std::uint16_t kDiscoveryServerPort = 11811;
/// GUID prefix of a discovery server with the id 0.
inline constexpr const char* kServerPrefix = "44.53.00.5f.45.50.52.4f.53.49.4d.41";

/// The UDP locator of `host` or `host:port`; names are looked up. A port of 0 leaves the choice to Fast DDS.
/// @param what   names the address in messages.
/// @throws ConfigError for another form, and for a name without an IPv4 address.
[[nodiscard]] Locator to_locator(std::string_view what, std::string_view address, std::uint16_t default_port);

/// The TCP locator of `host:port`, for the first participants of a process. @throws ConfigError likewise.
[[nodiscard]] Locator to_tcp_locator(std::string_view what, std::string_view address);

/// The numeric address of an interface of this host.
/// @throws ConfigError for an address that no interface has.
[[nodiscard]] std::string own_address(std::string_view what, std::string_view address);

}  // namespace hybridtest::fast_dds
