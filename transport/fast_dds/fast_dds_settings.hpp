#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"

namespace hybridtest::fast_dds {

/// TLS for TCP: files in PEM. Both ends of a connection show a certificate of the same authority.
struct TlsFiles {
  std::filesystem::path authority;
  std::filesystem::path certificate;
  std::filesystem::path key;
};

/// TCP in place of UDP. Of two participants at least one listens; those that only dial need no open port and may stand
/// behind a router that translates addresses.
struct TcpSettings {
  /// `host:port` on which others connect to this participant, as they dial it; none where nobody can.
  std::optional<std::string> listens_at;
  /// `host:port` of every participant that listens.
  std::vector<std::string> dials;
  std::optional<TlsFiles> tls;
};

/// How a participant finds and reaches the others: deployment, without protocol meaning.
struct FastDdsSettings {
  /// DDS domain, 0 to 232; it chooses the UDP ports.
  std::uint32_t domain = 0;

  /// Only this host: the loopback interface, unicast discovery on 127.0.0.1. Works without any
  /// network and without multicast.
  bool loopback_only = false;
  /// Participants on this host that can find each other with loopback_only, 1 to 200, counting
  /// all that one process made since its start. Each announcement is sent to this number of ports.
  std::uint32_t loopback_participants = 40;

  /// Shared memory between processes of one host besides UDP, where /dev/shm has room. Off by
  /// default: a round trip gets longer, see decision 7, and a killed process leaves segments
  /// behind that can block the communication of later ones; a killed process must harm no other.
  bool shared_memory = false;

  /// The thread that waits on Transport::waker() reads the socket of the messages itself: one hand-over between threads
  /// less for each message. Otherwise a thread of Fast DDS reads it and wakes that thread.
  bool receives_in_waiting_thread = true;
  /// Before it sleeps, the waiting thread looks at the socket again and again for this time, 0 to 1 s: shorter round
  /// trips for a processor that is busy all the time. For processors that nobody else needs.
  Duration busy_poll{0};
  /// For measurements: called by the waiting thread each time that something has arrived, before it is read.
  std::function<void()> when_woken = nullptr;

  /// Commands and measurements are sent once and not again by the network layer: in real time a packet after its
  /// deadline is useless and the next one repeats the history, and otherwise the coordinator repeats sooner, see
  /// decision 15. All participants of a test must agree.
  bool best_effort_coupling = false;

  /// Interface degrees of freedom of a command that Fast DDS sends in one packet. Of several, the network layer sends
  /// only what was lost.
  static constexpr std::size_t kDofsInOnePacket = 2000;

  /// A lost message is noticed within this time, 1 ms to 1 s. Each writer asks that often for a receipt, which wakes
  /// threads at both ends.
  Duration repair_period = repair_period_for(1);

  /// For a test of so many substructures: their coordinator gets and answers about 300 such questions a second.
  [[nodiscard]] static constexpr Duration repair_period_for(std::size_t substructures) noexcept {
    return std::max<Duration>(std::chrono::milliseconds{20}, substructures * std::chrono::milliseconds{3});
  }

  /// `host` or `host:port` of other participants, where multicast does not reach.
  std::vector<std::string> initial_peers;
  /// Besides the initial peers, look for others by multicast.
  bool looks_by_multicast = true;
  /// IPv4 address of the interface to use on a host with several networks; otherwise all of them.
  std::optional<std::string> interface_address;
  /// `host:port` of a discovery server (`hybridtest discovery-server`, or `fastdds discovery` with id 0), in place of
  /// multicast and peers.
  std::optional<std::string> discovery_server;
  /// In place of UDP and all of the above but the domain.
  std::optional<TcpSettings> tcp;
  /// Fast DDS XML profiles. Its participant profile named `hybridtest` takes the place of
  /// everything above but the domain (interfaces, TCP, security).
  std::optional<std::filesystem::path> profile_file;

  /// Folder of this participant's credentials: only participants with credentials of the same test are heard, each says
  /// what its permissions allow, and everything is encrypted. Works with a profile, too.
  std::optional<std::filesystem::path> credentials;

  /// A participant that sends nothing for this time is lost; at least 0.1 s.
  Duration lease = std::chrono::seconds{2};
  /// A participant whose rig can move and that sends no status for this time is lost as well: its
  /// process lives, its node does not. Every node repeats its status at least twice as often.
  Duration heartbeat_deadline = std::chrono::seconds{2};
  /// Id of this participant where it is a substructure. Then it hears the statuses of others with this id, which must
  /// be noticed, and of those who are no substructures, and of the rest nothing: what all hear from all grows with the
  /// square of their number.
  std::string substructure_id;
  /// Only listens to the statuses, and hears those of every test, whatever its lease: a reader that asks for a shorter
  /// lease than a writer offers is not matched with it. Not for participants of a test.
  bool is_observer = false;
  /// Readers ask nobody to send anything again, but for the announcement and the statuses, which late joiners need.
  /// For an observer that a test must not wait for and must not serve.
  bool reads_best_effort = false;
};

/// Reads the profile and looks up the host names, as joining a test does later.
/// @throws ConfigError for a value out of range, an address or host name that does not work, or a profile file or
///         credentials that cannot be used.
void require_usable(const FastDdsSettings& settings);

/// One line for the user on what does not pass the packet filter with these settings; empty where all of it does.
/// @throws ConfigError as require_usable().
[[nodiscard]] std::string unfiltered_text(const FastDdsSettings& settings);

}  // namespace hybridtest::fast_dds
