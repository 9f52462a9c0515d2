#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hybridtest::benchmarks {

/// The references for the coupled step, without our software: one command is sent to two peers in their
/// own processes, and both answers are received.
struct EchoSettings {
  int samples = 5000;
  int warm_up = 500;  // round trips before the first measured one
  std::uint32_t domain = 93;
  /// Plain Fast DDS only: `udp`, `shared_memory` (in addition to UDP), `library_default`.
  std::string network = "udp";
  /// Plain Fast DDS only: how a sample is noticed. `listener`: peers answer in the callback, the
  /// initiator's callback notifies its thread. `waitset`: every thread blocks in WaitSet::wait.
  std::string wait = "listener";
};

inline constexpr int kEchoPeers = 2;

/// Round-trip times [us], in the order measured. Throw std::runtime_error when a peer does not
/// answer. They start their peers as `/proc/self/exe echo_peer …`, so main() must begin with
/// echo_peer_main().
[[nodiscard]] std::vector<double> fast_dds_echo_us(const EchoSettings& settings);
[[nodiscard]] std::vector<double> udp_echo_us(const EchoSettings& settings);
/// The same through our transport, without nodes: two commands out, two measurements in.
[[nodiscard]] std::vector<double> transport_echo_us(const EchoSettings& settings);

/// Serves as a peer when the arguments say so and then returns its exit code.
[[nodiscard]] std::optional<int> echo_peer_main(int argc, char** argv);

// One peer of each kind; they run until killed by their parent. `port_or_run` joins the peers
// to their initiator: a UDP port, or the number of the run, part of the DDS partition.
[[noreturn]] void fast_dds_echo_peer(const EchoSettings& settings, int index, int run);
[[noreturn]] void udp_echo_peer(int port);
[[noreturn]] void transport_echo_peer(const EchoSettings& settings, int index, int run);

}  // namespace hybridtest::benchmarks
