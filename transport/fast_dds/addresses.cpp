#include "transport/fast_dds/addresses.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <vector>

#include "core/config_error.hpp"

namespace hybridtest::fast_dds {
namespace {

[[noreturn]] void refuse_address(std::string_view what, std::string_view address, const std::string& why) {
  throw ConfigError{std::string{what} + " '" + std::string{address} + "': " + why};
}

}  // namespace

Locator to_locator(std::string_view what, std::string_view address, std::uint16_t default_port) {
  const std::string_view host = address.substr(0, address.find(':'));
  if (host.empty()) refuse_address(what, address, "expected host or host:port");
  std::uint16_t port = default_port;
  if (host.size() < address.size()) {
    const std::string_view digits = address.substr(host.size() + 1);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
    if (error != std::errc{} || end != digits.data() + digits.size() || port == 0) {
      refuse_address(what, address, "expected host or host:port, port 1 to 65535");
    }
  }
  Locator locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  locator.port = port;
  std::string numeric{host};
  if (!IpLocator::isIPv4(numeric)) {
    const auto addresses = IpLocator::resolveNameDNS(numeric);
    if (addresses.first.empty()) refuse_address(what, address, "this host has no IPv4 address; check its name");
    numeric = *addresses.first.begin();
  }
  IpLocator::setIPv4(locator, numeric);
  return locator;
}

Locator to_tcp_locator(std::string_view what, std::string_view address) {
  const Locator udp = to_locator(what, address, 0);
  if (udp.port == 0) refuse_address(what, address, "TCP needs a port; expected host:port");
  Locator locator;
  locator.kind = LOCATOR_KIND_TCPv4;
  IpLocator::setIPv4(locator, IpLocator::toIPv4string(udp));
  IpLocator::setPhysicalPort(locator, static_cast<std::uint16_t>(udp.port));
  return locator;
}

std::string own_address(std::string_view what, std::string_view address) {
  std::string numeric = IpLocator::toIPv4string(to_locator(what, address, 0));
  std::vector<IpFinder::info_IP> interfaces;
  IpFinder::getIPs(&interfaces, true);
  const bool is_own = std::ranges::any_of(interfaces, [&](const auto& one) { return one.name == numeric; });
  if (!is_own)
    refuse_address(what, address, "no interface of this host has this address; see the command `ip address`");
  return numeric;
}

}  // namespace hybridtest::fast_dds
