#include <sys/prctl.h>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string_view>

#include "benchmarks/echo.hpp"

namespace hybridtest::benchmarks {

std::vector<std::string> echo_peer_arguments(const std::string& kind, int index, int run,
                                             const EchoSettings& settings) {
  return {"echo_peer",
          kind,
          std::to_string(index),
          std::to_string(run),
          std::to_string(settings.domain),
          settings.network,
          settings.wait,
          settings.best_effort ? "best_effort" : "reliable",
          settings.receive,
          std::to_string(settings.busy_poll_us),
          std::to_string(settings.peers)};
}

std::optional<int> echo_peer_main(int argc, char** argv, const EchoPeer& nodes) {
  if (argc < 4 || std::string_view{argv[1]} != "echo_peer") return std::nullopt;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // no peer survives a stopped benchmark
  try {
    const std::string_view kind{argv[2]};
    if (kind == "udp") udp_echo_peer(std::atoi(argv[3]));
    if (argc < 12) return 64;
    const int index = std::atoi(argv[3]);
    const int run = std::atoi(argv[4]);
    EchoSettings settings;
    settings.domain = static_cast<std::uint32_t>(std::atoi(argv[5]));
    settings.network = argv[6];
    settings.wait = argv[7];
    settings.best_effort = std::string_view{argv[8]} == "best_effort";
    settings.receive = argv[9];
    settings.busy_poll_us = std::atoi(argv[10]);
    settings.peers = std::atoi(argv[11]);
    if (kind == "fast_dds") fast_dds_echo_peer(settings, index, run);
    if (kind == "transport") transport_echo_peer(settings, index, run);
    if (kind == "nodes" && nodes) return nodes(settings, index, run);
    return 64;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "echo peer: %s\n", error.what());
    return 1;
  }
}

}  // namespace hybridtest::benchmarks
