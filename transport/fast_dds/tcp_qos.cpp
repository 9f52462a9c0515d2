#include "transport/fast_dds/tcp_qos.hpp"

#include <memory>
#include <optional>
#include <string>

#include "core/config_error.hpp"
#include "core/input_file.hpp"
#include "transport/fast_dds/addresses.hpp"
#include "transport/fast_dds/tcp_transport.hpp"

namespace hybridtest::fast_dds {
namespace {

/// Discovery and data of every participant go to this one logical port (Fast DDS has one for each otherwise). A logical
/// port is opened by a request. When the main thread of Fast DDS 2.9 asks and another thread reads the answer before
/// the first has noted its question, the port stays closed for ever, and nothing that is sent to it arrives. That can
/// happen to the port of data, which is asked for whenever a reader is found, but not to that of discovery: it is asked
/// for before the connection is made, or by the thread that will read the answer.
std::uint16_t logical_port(std::uint32_t domain) {
  return static_cast<std::uint16_t>(PortParameters{}.getUnicastPort(domain, 0));
}

/// Where a participant is that nobody can connect to: Fast DDS fills in the rest.
Locator anywhere() {
  Locator locator;
  locator.kind = LOCATOR_KIND_TCPv4;
  locator.set_Invalid_Address();
  return locator;
}

std::string readable(const char* what, const std::filesystem::path& file) {
  if (const auto why = why_unreadable(file)) {
    throw ConfigError{{ConfigIssue{.file = file.string(), .what = std::string{what} + " cannot be read: " + *why}}};
  }
  return file.string();
}

void add_tls(const TlsFiles& files, rtps::TCPTransportDescriptor& tcp) {
  using Tls = rtps::TCPTransportDescriptor::TLSConfig;
  tcp.apply_security = true;
  tcp.tls_config.verify_file = readable("tls: the certificate of the authority", files.authority);
  tcp.tls_config.cert_chain_file = readable("tls: the certificate of this participant", files.certificate);
  tcp.tls_config.private_key_file = readable("tls: the key of this participant", files.key);
  // Nobody without a certificate, at either end.
  tcp.tls_config.add_verify_mode(Tls::TLSVerifyMode::VERIFY_PEER);
  tcp.tls_config.add_verify_mode(Tls::TLSVerifyMode::VERIFY_FAIL_IF_NO_PEER_CERT);
  for (const auto old :
       {Tls::TLSOptions::DEFAULT_WORKAROUNDS, Tls::TLSOptions::NO_COMPRESSION, Tls::TLSOptions::NO_SSLV2,
        Tls::TLSOptions::NO_SSLV3, Tls::TLSOptions::NO_TLSV1, Tls::TLSOptions::NO_TLSV1_1}) {
    tcp.tls_config.add_option(old);
  }
}

}  // namespace

void add_tcp(const FastDdsSettings& all, const std::shared_ptr<RefusedPackets>& refused,
             dds::DomainParticipantQos& qos) {
  const TcpSettings& settings = *all.tcp;
  if (!settings.listens_at && settings.dials.empty()) {
    throw ConfigError{"over TCP at least one participant listens, and the others know its host:port"};
  }
  const auto tcp = std::make_shared<rtps::TCPv4TransportDescriptor>();
  // A step waits for each message: the kernel must not collect several.
  tcp->enable_tcp_nodelay = true;
  if (all.interface_address) tcp->interfaceWhiteList.push_back(own_address("interface", *all.interface_address));
  if (settings.tls) add_tls(*settings.tls, *tcp);
  const auto with_logical_port = [&](Locator locator) {
    IpLocator::setLogicalPort(locator, logical_port(all.domain));
    return locator;
  };
  Locator own = anywhere();
  if (settings.listens_at) {
    own = to_tcp_locator("listens", *settings.listens_at);
    tcp->add_listener_port(IpLocator::getPhysicalPort(own));
  }
  qos.wire_protocol().builtin.metatrafficUnicastLocatorList.push_back(with_logical_port(own));
  qos.wire_protocol().default_unicast_locator_list.push_back(with_logical_port(own));
  for (const std::string& address : settings.dials) {
    qos.wire_protocol().builtin.initialPeersList.push_back(with_logical_port(to_tcp_locator("peer", address)));
  }
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(tcp_transport(tcp, settings.listens_at ? std::optional{own} : std::nullopt,
                                                          all.credentials ? Admission::secured : Admission::plain,
                                                          refused));
}

}  // namespace hybridtest::fast_dds
