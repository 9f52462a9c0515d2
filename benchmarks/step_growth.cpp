// step_growth [--sites N,N,...] [--steps N] [--rounds N]
//
// Measures, in one run on one machine, how the time of a coupled step grows with the number of numerical
// substructures, each of which is a process: the cost per substructure over that with the first number.
// Beside it the same for a plain UDP echo and a plain Fast DDS echo with as many peers: more processes than
// processors cost more each, whatever they run.

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>

#include "benchmarks/coupled_programs.hpp"
#include "benchmarks/echo.hpp"
#include "benchmarks/latency_report.hpp"
#include "benchmarks/traced_steps.hpp"

namespace hybridtest::benchmarks {
namespace {

struct Growth {
  std::vector<double> step_us;
  std::vector<double> echo_us;
  std::vector<double> udp_us;
};

void append(std::vector<double>& all, const std::vector<double>& round) {
  all.insert(all.end(), round.begin(), round.end());
}

void measure(EchoSettings settings, Growth& growth) {
  const std::filesystem::path scenario =
      std::filesystem::temp_directory_path() / ("step_growth_" + std::to_string(::getpid()) + ".yaml");
  write_storeys(scenario, settings.peers, settings.samples + settings.warm_up);
  std::vector<std::string> ids;
  for (int i = 1; i <= settings.peers; ++i) ids.push_back("storey_" + std::to_string(i));
  append(growth.step_us, coupled_step_us(scenario, ids, settings.warm_up, settings.domain, {}));
  std::filesystem::remove(scenario);
  append(growth.echo_us, fast_dds_echo_us(settings));
  append(growth.udp_us, udp_echo_us(settings));
}

int run(const std::vector<int>& sites, int rounds, EchoSettings settings) {
  std::map<int, Growth> measured;
  for (int round = 0; round < rounds; ++round) {
    for (const int count : sites) {
      std::fprintf(stderr, "round %d of %d, %d substructures\n", round + 1, rounds, count);
      settings.peers = count;
      measure(settings, measured[count]);
    }
  }
  std::printf("median per substructure [us], and over that with %d\n", sites.front());
  std::printf("%5s  %18s  %18s  %18s\n", "sites", "coupled step", "Fast DDS echo", "UDP echo");
  const auto cost = [&](const std::vector<double>& times_us, int count) {
    return percentile_us(times_us, 0.5) / count;
  };
  const Growth& first = measured[sites.front()];
  for (const int count : sites) {
    const Growth& growth = measured[count];
    std::printf("%5d", count);
    for (const auto times : {&Growth::step_us, &Growth::echo_us, &Growth::udp_us}) {
      const double per_site_us = cost(growth.*times, count);
      std::printf("  %10.1f  %5.2fx", per_site_us, per_site_us / cost(first.*times, sites.front()));
    }
    std::printf("\n");
  }
  return 0;
}

}  // namespace
}  // namespace hybridtest::benchmarks

int main(int argc, char** argv) {
  using namespace hybridtest::benchmarks;
  if (const std::optional<int> code = echo_peer_main(argc, argv)) return *code;
  CLI::App app{"Growth of a coupled step with the number of substructures, measured in one run"};
  EchoSettings settings;
  settings.samples = 2000;
  settings.warm_up = 200;
  std::vector<int> sites{2, 8, 16, 32};
  int rounds = 1;
  app.add_option("--sites", sites, "Numbers of substructures")
      ->delimiter(',')
      ->check(CLI::Range(2, 32))
      ->capture_default_str();
  app.add_option("--steps", settings.samples, "Number of measured steps and echoes per round")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--rounds", rounds, "Number of rounds")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--domain", settings.domain, "DDS domain")->check(CLI::Range(0, 232))->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    return run(sites, rounds, settings);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "step_growth: %s\n", error.what());
    return 1;
  }
}
