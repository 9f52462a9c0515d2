// step_growth [--sites N,N,...] [--steps N] [--rounds N]
//
// Measures, in one run on one machine, how a coupled step grows with the number of numerical substructures, each of
// which is a process: time and processor time of all processes, per substructure, over that with the first number.
// Processor time is that of the steps alone: a run of few steps is taken off. Beside it the same for a plain UDP echo
// and a plain Fast DDS echo with as many peers: more processes than processors cost more each, whatever they run,
// because none finds its memory in the caches.

#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <vector>

#include "benchmarks/coupled_programs.hpp"
#include "benchmarks/echo.hpp"
#include "benchmarks/latency_report.hpp"
#include "benchmarks/traced_steps.hpp"

namespace hybridtest::benchmarks {
namespace {

/// Of one kind of step or round trip.
struct Series {
  std::vector<double> times_us;
  double processor_us = 0.0;  // of `steps` more or less of them
  int steps = 0;
};

struct Growth {
  Series step;
  Series echo;
  Series udp;
};

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
}

/// Of this process and of its children that have ended.
double processor_us() {
  double sum_s = 0.0;
  for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    ::getrusage(who, &usage);
    sum_s += seconds(usage.ru_utime) + seconds(usage.ru_stime);
  }
  return sum_s * 1e6;
}

using Measure = std::function<std::vector<double>(const EchoSettings&)>;

void add(Series& series, EchoSettings settings, const Measure& measure) {
  const double begin_us = processor_us();
  const std::vector<double> times_us = measure(settings);
  const double middle_us = processor_us();
  const int samples = settings.samples;
  settings.samples = 1;
  static_cast<void>(measure(settings));
  series.times_us.insert(series.times_us.end(), times_us.begin(), times_us.end());
  series.processor_us += 2.0 * middle_us - begin_us - processor_us();
  series.steps += samples - 1;
}

std::vector<double> coupled(const EchoSettings& settings) {
  const std::filesystem::path scenario =
      std::filesystem::temp_directory_path() / ("step_growth_" + std::to_string(::getpid()) + ".yaml");
  write_storeys(scenario, settings.peers, settings.samples + settings.warm_up);
  std::vector<std::string> ids;
  for (int i = 1; i <= settings.peers; ++i) ids.push_back("storey_" + std::to_string(i));
  std::vector<double> times_us = coupled_step_us(scenario, ids, settings.warm_up, settings.domain, {});
  std::filesystem::remove(scenario);
  return times_us;
}

void measure(const EchoSettings& settings, Growth& growth) {
  add(growth.step, settings, coupled);
  add(growth.echo, settings, fast_dds_echo_us);
  add(growth.udp, settings, udp_echo_us);
}

using PerSite = std::function<double(const Series&, int)>;

void print(const char* what, const std::vector<int>& sites, const std::map<int, Growth>& measured,
           const PerSite& per_site) {
  std::printf("%s per substructure [us], and over that with %d\n", what, sites.front());
  std::printf("%5s  %18s  %18s  %18s\n", "sites", "coupled step", "Fast DDS echo", "UDP echo");
  const Growth& first = measured.at(sites.front());
  for (const int count : sites) {
    std::printf("%5d", count);
    for (const auto series : {&Growth::step, &Growth::echo, &Growth::udp}) {
      const double per_site_us = per_site(measured.at(count).*series, count);
      std::printf("  %10.1f  %5.2fx", per_site_us, per_site_us / per_site(first.*series, sites.front()));
    }
    std::printf("\n");
  }
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
  print("median", sites, measured,
        [](const Series& series, int count) { return percentile_us(series.times_us, 0.5) / count; });
  print("processor time of a step", sites, measured,
        [](const Series& series, int count) { return series.processor_us / series.steps / count; });
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
