#include "transport/fast_dds/participant_qos.hpp"

#include <algorithm>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "core/config_error.hpp"
#include "core/input_file.hpp"
#include "transport/fast_dds/addresses.hpp"
#include "transport/fast_dds/dds_version.hpp"
#include "transport/fast_dds/filtered_transport.hpp"
#include "transport/fast_dds/polled_transport.hpp"
#include "transport/fast_dds/security_qos.hpp"
#include "transport/fast_dds/tcp_qos.hpp"
#include "transport/fast_dds/tcp_transport.hpp"
#include "transport/fast_dds/topics.hpp"

namespace hybridtest::fast_dds {
namespace {

constexpr const char* kLoopback = "127.0.0.1";
constexpr Duration kAnnouncementPeriodMax = std::chrono::milliseconds{500};
// Fast DDS looks once in this many leases whether a participant is still there. When that falls into the removal of
// another one, 2.9 locks up, or aborts on an assertion (eProsima/Fast-DDS issue 6502); with 32 that leave together it
// did in every sixth run. What has been lost is found sooner, by the statuses that stop.
constexpr int kLeasesOfParticipant = 20;
constexpr const char* kProfileName = "hybridtest";

void check(const FastDdsSettings& settings) {
  if (settings.domain > 232) throw ConfigError{"the DDS domain must be 0 to 232"};
  if (settings.loopback_participants < 1 || settings.loopback_participants > 200) {
    throw ConfigError{"loopback_participants must be 1 to 200"};
  }
  if (settings.lease < std::chrono::milliseconds{100} || settings.heartbeat_deadline < std::chrono::milliseconds{100}) {
    throw ConfigError{"the lease and the heartbeat deadline must be 0.1 s or longer"};
  }
  if (settings.repair_period < std::chrono::milliseconds{1} || settings.repair_period > std::chrono::seconds{1}) {
    throw ConfigError{"the repair period must be 1 ms to 1 s"};
  }
  if (settings.busy_poll < Duration{0} || settings.busy_poll > std::chrono::seconds{1}) {
    throw ConfigError{"the busy poll must be 0 to 1 s"};
  }
}

// Fast DDS maps its segments completely, and SIGBUS kills the process if the file system is smaller.
bool has_room_for_shared_memory() {
  constexpr std::uintmax_t kRoom = 8U << 20U;
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space("/dev/shm", error);
  return !error && space.available >= kRoom;
}

Admission admission_of(const FastDdsSettings& settings, bool has_discovery_server) {
  if (!settings.credentials) return Admission::plain;
  return has_discovery_server ? Admission::secured_by_server : Admission::secured;
}

void add_transports(const FastDdsSettings& settings, const std::shared_ptr<PolledSocket>& socket,
                    const std::shared_ptr<RefusedPackets>& refused, dds::DomainParticipantQos& qos) {
  const auto udp = std::make_shared<rtps::UDPv4TransportDescriptor>();
  // A full socket buffer loses a packet, and the protocol sends it again. A blocked step cannot be repaired.
  udp->non_blocking_send = true;
  udp->maxInitialPeersRange = settings.loopback_participants;
  if (settings.loopback_only) {
    udp->interfaceWhiteList.emplace_back(kLoopback);
  } else if (settings.interface_address) {
    udp->interfaceWhiteList.push_back(own_address("interface", *settings.interface_address));
  }
  qos.transport().use_builtin_transports = false;
  if (socket) {
    qos.transport().user_transports.push_back(
        polled_transport(udp, socket, settings.domain, settings.loopback_only,
                         admission_of(settings, settings.discovery_server.has_value()), refused));
  } else {
    qos.transport().user_transports.push_back(udp);
  }
  if (settings.shared_memory && has_room_for_shared_memory()) {
    qos.transport().user_transports.push_back(std::make_shared<rtps::SharedMemTransportDescriptor>());
  }
}

void add_discovery(const FastDdsSettings& settings, dds::DomainParticipantQos& qos) {
  auto& builtin = qos.wire_protocol().builtin;
  if (settings.discovery_server) {
    RemoteServer server;
    server.ReadguidPrefix(kServerPrefix);
    server.metatrafficUnicastLocatorList.push_back(
        to_locator("discovery server", *settings.discovery_server, kDiscoveryServerPort));
    builtin.discovery_config.discoveryProtocol = DiscoveryProtocol::CLIENT;
    builtin.discovery_config.m_DiscoveryServers.push_back(server);
    return;
  }
  if (settings.loopback_only) {
    // With explicit metatraffic locators Fast DDS does not add its multicast locators.
    builtin.metatrafficUnicastLocatorList.push_back(to_locator("peer", kLoopback, 0));
    builtin.initialPeersList.push_back(to_locator("peer", kLoopback, 0));
  }
  for (const std::string& peer : settings.initial_peers)
    builtin.initialPeersList.push_back(to_locator("peer", peer, 0));
  if (settings.looks_by_multicast && !settings.loopback_only && !settings.initial_peers.empty()) {
    // A list of peers replaces multicast discovery unless multicast is one of them.
    builtin.initialPeersList.push_back(to_locator("peer", "239.255.0.1", 0));
  }
}

dds::DomainParticipantQos profile_qos(const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& why) {
    throw ConfigError{{ConfigIssue{.file = file.string(), .what = why}}};
  };
  const std::string expected =
      std::string{"expected Fast DDS XML with a participant profile named '"} + kProfileName + "'";
  if (const auto why = why_unreadable(file)) refuse("cannot be read: " + *why + "; " + expected);
  auto* factory = dds::DomainParticipantFactory::get_instance();
  if (factory->load_XML_profiles_file(file.string()) != kReturnOk) refuse("is not a valid profile file; " + expected);
  dds::DomainParticipantQos qos;
  if (factory->get_participant_qos_from_profile(kProfileName, qos) != kReturnOk) {
    refuse("has no such profile; " + expected);
  }
  return qos;
}

/// The transports that Fast DDS makes when a profile leaves them to it.
void spell_out_builtin_transports(dds::DomainParticipantQos& qos) {
  auto& transports = qos.transport();
  if (!std::exchange(transports.use_builtin_transports, false)) return;
  const auto udp = std::make_shared<rtps::UDPv4TransportDescriptor>();
  udp->sendBufferSize = transports.send_socket_buffer_size;
  udp->receiveBufferSize = transports.listen_socket_buffer_size;
  auto& all = transports.user_transports;
  all.insert(all.begin(), udp);
  if (has_room_for_shared_memory()) {
    all.insert(all.begin() + 1, std::make_shared<rtps::SharedMemTransportDescriptor>());
  }
}

bool is_shared_memory(const std::shared_ptr<rtps::TransportDescriptorInterface>& transport) {
  return std::dynamic_pointer_cast<rtps::SharedMemTransportDescriptor>(transport) != nullptr;
}

/// Puts the packet filter before the transports of a profile, but for shared memory: Fast DDS looks for it among them.
void add_filter(const FastDdsSettings& settings, const std::shared_ptr<RefusedPackets>& refused,
                dds::DomainParticipantQos& qos) {
  const bool has_server = qos.wire_protocol().builtin.discovery_config.discoveryProtocol != DiscoveryProtocol::SIMPLE;
  const Admission admission = admission_of(settings, has_server);
  for (auto& transport : qos.transport().user_transports) {
    if (is_shared_memory(transport)) continue;
    const bool is_tcp = std::dynamic_pointer_cast<rtps::TCPTransportDescriptor>(transport) != nullptr;
    transport = is_tcp ? tcp_transport(transport, std::nullopt, admission, refused)
                       : filtered_transport(transport, admission, refused);
  }
}

}  // namespace

std::string unfiltered_text(const FastDdsSettings& settings) {
  const dds::DomainParticipantQos qos = participant_qos(settings);
  if (std::ranges::none_of(qos.transport().user_transports, is_shared_memory)) return {};
  return (settings.profile_file ? settings.profile_file->string() + ": " : std::string{}) +
         "what other processes of this host send through shared memory does not pass the packet filter "
         "(docs/security.md)";
}

void require_usable(const FastDdsSettings& settings) { static_cast<void>(participant_qos(settings)); }

dds::DomainParticipantQos participant_qos(const FastDdsSettings& settings, const std::shared_ptr<PolledSocket>& socket,
                                          const std::shared_ptr<RefusedPackets>& refused) {
  check(settings);
  dds::DomainParticipantQos qos;
  if (settings.profile_file) {
    qos = profile_qos(*settings.profile_file);
    spell_out_builtin_transports(qos);
    add_filter(settings, refused, qos);
  } else if (settings.tcp) {
    add_tcp(settings, refused, qos);
  } else {
    add_transports(settings, socket, refused, qos);
    add_discovery(settings, qos);
  }
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.leaseDuration = to_dds(kLeasesOfParticipant * settings.lease);
  // An announcement can be lost. Whoever joins later, such as the tool of an emergency stop, waits for the next one.
  discovery.leaseDuration_announcementperiod = to_dds(std::min(settings.lease / 4, kAnnouncementPeriodMax));
  // Existing participants answer the first announcement at once. The repeats are for participants
  // that open their socket a little later.
  discovery.initial_announcements.count = 10;
  discovery.initial_announcements.period = to_dds(std::chrono::milliseconds{50});
  // Tells other programs how the types of our messages are made, when they ask. Fast DDS 2.9 asks each participant in
  // turn whether it has a question, 14 times a second and for ever: one answers for the test, not all of it to all of
  // it.
  qos.wire_protocol().builtin.typelookup_config.use_server = settings.substructure_id.empty();
  qos.name("hybridtest");
  if (settings.credentials) add_security(*settings.credentials, qos);
  return qos;
}

}  // namespace hybridtest::fast_dds
