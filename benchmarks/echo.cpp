// echo [fast_dds|udp|transport|all] [--samples N] [--rounds N] [--peers N] [--best-effort] …
// Prints one line of JSON per round and kind. The kinds alternate, so that other work on the machine
// affects all of them.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "benchmarks/echo.hpp"
#include "benchmarks/latency_report.hpp"

int main(int argc, char** argv) {
  using namespace hybridtest::benchmarks;
  if (const std::optional<int> code = echo_peer_main(argc, argv)) return *code;

  CLI::App app{"Round-trip time of one command to each peer, in its own process, until all answers have arrived"};
  EchoSettings settings;
  std::string kind = "all";
  int rounds = 1;
  app.add_option("kind", kind, "fast_dds, udp, transport or all")
      ->check(CLI::IsMember({"fast_dds", "udp", "transport", "all"}));
  app.add_option("--samples", settings.samples, "number of measured round trips per round")->check(CLI::PositiveNumber);
  app.add_option("--rounds", rounds, "number of rounds")->check(CLI::PositiveNumber);
  app.add_option("--network", settings.network, "udp, shared_memory (besides UDP) or library_default")
      ->check(CLI::IsMember({"udp", "shared_memory", "library_default"}));
  app.add_option("--wait", settings.wait, "plain Fast DDS: listener or waitset")
      ->check(CLI::IsMember({"listener", "waitset"}));
  app.add_flag("--best-effort", settings.best_effort, "Fast DDS: nothing is sent again");
  app.add_option("--receive", settings.receive, "our transport: the waiting thread, or a thread of Fast DDS, receives")
      ->check(CLI::IsMember({"waiting", "thread"}));
  app.add_option("--busy-poll-us", settings.busy_poll_us,
                 "our transport: look at the socket for so long before sleeping")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--peers", settings.peers, "number of peers")->check(CLI::Range(1, kEchoPeersMax));
  app.add_option("--domain", settings.domain, "DDS domain")->check(CLI::Range(0, 232));
  CLI11_PARSE(app, argc, argv);

  const auto wanted = [&](const char* name) { return kind == "all" || kind == name; };
  const std::string quality = settings.best_effort ? " best_effort" : " reliable";
  const auto print = [](const std::string& what, const std::vector<double>& times_us) {
    std::printf("%s\n", latency_json(what, times_us).c_str());
    std::fflush(stdout);
  };
  try {
    for (int round = 0; round < rounds; ++round) {
      if (wanted("udp")) print("udp", udp_echo_us(settings));
      if (wanted("fast_dds"))
        print("fast_dds " + settings.network + " " + settings.wait + quality, fast_dds_echo_us(settings));
      if (wanted("transport"))
        print("transport " + settings.network + " " + settings.receive + quality, transport_echo_us(settings));
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "echo: %s\n", error.what());
    return 1;
  }
  return 0;
}
