#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hybridtest::benchmarks {

/// Largest number of peers.
inline constexpr int kEchoPeersMax = 32;

/// The references for the coupled step, without our software: one command is sent to each peer, in its
/// own process, and all answers are received.
struct EchoSettings {
  int samples = 5000;
  int warm_up = 500;  // round trips before the first measured one
  std::uint32_t domain = 93;
  /// Plain Fast DDS only: `udp`, `shared_memory` (in addition to UDP), `library_default`.
  std::string network = "udp";
  /// Plain Fast DDS only: how a sample is noticed. `listener`: peers answer in the callback, the
  /// initiator's callback notifies its thread. `waitset`: every thread blocks in WaitSet::wait.
  std::string wait = "listener";
  /// Fast DDS, plain and ours: commands and answers are not sent again.
  bool best_effort = false;
  /// Our transport only: `waiting` (the thread that waits receives itself) or `thread` (one of Fast DDS does).
  std::string receive = "waiting";
  /// Our transport only: how long a thread looks at its socket before it sleeps [us].
  int busy_poll_us = 0;
  int peers = 2;
};

/// Round-trip times [us], in the order measured. Throw std::runtime_error when a peer does not
/// answer. They start their peers as `/proc/self/exe echo_peer …`, so main() must begin with
/// echo_peer_main().
[[nodiscard]] std::vector<double> fast_dds_echo_us(const EchoSettings& settings);
[[nodiscard]] std::vector<double> udp_echo_us(const EchoSettings& settings);
/// The same through our transport, without nodes: a command to each peer out, their measurements in.
[[nodiscard]] std::vector<double> transport_echo_us(const EchoSettings& settings);

/// Serves as a peer of the settings with this index; returns its exit code.
using EchoPeer = std::function<int(const EchoSettings& settings, int index, int run)>;

/// Serves as a peer when the arguments say so and then returns its exit code.
/// @param nodes   the peer of the kind `nodes`, for programs that have one.
[[nodiscard]] std::optional<int> echo_peer_main(int argc, char** argv, const EchoPeer& nodes = nullptr);

/// Arguments for a peer of a kind that uses the settings.
[[nodiscard]] std::vector<std::string> echo_peer_arguments(const std::string& kind, int index, int run,
                                                           const EchoSettings& settings);

// One peer of each kind; they run until killed by their parent. `port_or_run` joins the peers
// to their initiator: a UDP port, or the number of the run, part of the DDS partition.
[[noreturn]] void fast_dds_echo_peer(const EchoSettings& settings, int index, int run);
[[noreturn]] void udp_echo_peer(int port);
[[noreturn]] void transport_echo_peer(const EchoSettings& settings, int index, int run);

}  // namespace hybridtest::benchmarks
