#include "transport/fast_dds/discovery_server.hpp"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <sstream>
#include <stdexcept>

#include "transport/fast_dds/addresses.hpp"
#include "transport/fast_dds/dds_version.hpp"

namespace hybridtest::fast_dds {
namespace {

/// Fast DDS takes another port in silence when this one is in use.
void require_free(std::uint16_t port) {
  const int probe = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  const bool is_free = probe >= 0 && bind(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  if (probe >= 0) close(probe);
  if (!is_free) {
    throw std::runtime_error{"UDP port " + std::to_string(port) +
                             " is in use: another discovery server runs on this host, or choose another port"};
  }
}

dds::DomainParticipantQos server_qos(std::uint16_t port, const std::optional<std::string>& interface_address) {
  dds::DomainParticipantQos qos;
  qos.name("hybridtest discovery server");
  qos.wire_protocol().prefix = GuidPrefix{};
  auto& builtin = qos.wire_protocol().builtin;
  builtin.discovery_config.discoveryProtocol = DiscoveryProtocol::SERVER;
  const auto udp = std::make_shared<rtps::UDPv4TransportDescriptor>();
  std::string address = "0.0.0.0";
  if (interface_address) {
    address = own_address("interface", *interface_address);
    udp->interfaceWhiteList.push_back(address);
  }
  std::istringstream prefix{kServerPrefix};
  prefix >> qos.wire_protocol().prefix;
  builtin.metatrafficUnicastLocatorList.push_back(to_locator("discovery server", address, port));
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  return qos;
}

}  // namespace

class DiscoveryServer::Server {
 public:
  explicit Server(const dds::DomainParticipantQos& qos)
      : participant_{dds::DomainParticipantFactory::get_instance()->create_participant(0, qos)} {
    if (participant_ == nullptr) throw std::runtime_error{"Fast DDS could not create the discovery server"};
  }
  ~Server() { dds::DomainParticipantFactory::get_instance()->delete_participant(participant_); }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

 private:
  dds::DomainParticipant* participant_;
};

DiscoveryServer::DiscoveryServer(std::uint16_t port, const std::optional<std::string>& interface_address) {
  require_free(port);
  server_ = std::make_unique<Server>(server_qos(port, interface_address));
}

DiscoveryServer::~DiscoveryServer() = default;

}  // namespace hybridtest::fast_dds
