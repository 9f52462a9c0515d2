#include <sys/prctl.h>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string_view>

#include "benchmarks/echo.hpp"

namespace hybridtest::benchmarks {

std::optional<int> echo_peer_main(int argc, char** argv) {
  if (argc < 4 || std::string_view{argv[1]} != "echo_peer") return std::nullopt;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // no peer survives a stopped benchmark
  try {
    const std::string_view kind{argv[2]};
    if (kind == "udp") udp_echo_peer(std::atoi(argv[3]));
    if (argc < 8) return 64;
    EchoSettings settings;
    const int index = std::atoi(argv[3]);
    const int run = std::atoi(argv[4]);
    settings.domain = static_cast<std::uint32_t>(std::atoi(argv[5]));
    settings.network = argv[6];
    settings.wait = argv[7];
    if (kind == "fast_dds") fast_dds_echo_peer(settings, index, run);
    if (kind == "transport") transport_echo_peer(settings, index, run);
    return 64;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "echo peer: %s\n", error.what());
    return 1;
  }
}

}  // namespace hybridtest::benchmarks
