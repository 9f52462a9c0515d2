// coupled_step [--rounds N] [--steps N] [--json FILE]
//
// Measures, in one run on one machine: the time of one coupled step (send the command, two substructures
// in their own processes answer, the integrator advances, the step is recorded, send the next command); a
// plain Fast DDS echo with the same payload, QoS and number of peers; and a plain UDP echo. The three take
// turns, so that other work on the machine affects all of them. The results are the ratios.

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "benchmarks/echo.hpp"
#include "benchmarks/latency_report.hpp"
#include "core/child_process.hpp"
#include "recording/run_file_reader.hpp"

namespace hybridtest::benchmarks {
namespace {

constexpr int kWarmUpSteps = 500;

/// Time between the sending of commands of consecutive steps, as the coordinator records it.
std::vector<double> coupled_step_us(int steps, unsigned domain) {
  const std::filesystem::path out =
      std::filesystem::temp_directory_path() / ("coupled_step_" + std::to_string(getpid()));
  std::filesystem::remove_all(out);
  std::filesystem::create_directories(out);
  const std::filesystem::path programs{HYBRIDTEST_PROGRAM_DIR};
  const std::vector<std::string> arguments{
      "--scenario",     HYBRIDTEST_SOURCE_DIR "/benchmarks/coupled_step.yaml",
      "--set",          "time.duration_s=" + std::to_string((steps + kWarmUpSteps) * 1e-3),
      "--out",          out.string(),
      "--domain",       std::to_string(domain),
      "--loopback-only"};
  std::vector<std::unique_ptr<ChildProcess>> children;
  const auto start = [&](const char* id, const char* program, std::vector<std::string> its_arguments) {
    children.push_back(std::make_unique<ChildProcess>(id, ChildStart{.program = programs / program,
                                                                     .arguments = std::move(its_arguments),
                                                                     .log_file = out / (std::string{id} + ".log")}));
  };
  start("coordinator", "coordinator", arguments);
  for (const char* id : {"storey_1", "storey_2"}) {
    std::vector<std::string> with_id = arguments;
    with_id.insert(with_id.end(), {"--id", id});
    start(id, "numerical_substructure", with_id);
  }
  for (const auto& child : children) {
    while (child->is_running()) usleep(20'000);
    if (child->exit_code() != 0) {
      throw std::runtime_error{child->id() + " failed; see " + child->log_file().string()};
    }
  }
  const std::vector<double> wall_s = RunFileReader{out / "coordinator.h5"}.column("steps", "wall_time_s");
  std::vector<double> times_us;
  for (std::size_t i = kWarmUpSteps + 1; i < wall_s.size(); ++i) times_us.push_back((wall_s[i] - wall_s[i - 1]) * 1e6);
  std::filesystem::remove_all(out);
  return times_us;
}

void append(std::vector<double>& all, const std::vector<double>& round) {
  all.insert(all.end(), round.begin(), round.end());
}

void print_ratio(const char* what, const std::vector<double>& step_us, const std::vector<double>& yardstick_us) {
  std::printf("coupled step / %-18s median %.2f   99th percentile %.2f\n", what,
              percentile_us(step_us, 0.5) / percentile_us(yardstick_us, 0.5),
              percentile_us(step_us, 0.99) / percentile_us(yardstick_us, 0.99));
}

int run(int rounds, EchoSettings settings, const std::string& json_file) {
  std::vector<double> step_us;
  std::vector<double> echo_us;
  std::vector<double> udp_us;
  for (int round = 0; round < rounds; ++round) {
    std::fprintf(stderr, "round %d of %d\n", round + 1, rounds);
    append(step_us, coupled_step_us(settings.samples, settings.domain));
    append(echo_us, fast_dds_echo_us(settings));
    append(udp_us, udp_echo_us(settings));
  }
  const std::vector<std::string> lines{latency_json("coupled_step", step_us), latency_json("fast_dds_echo", echo_us),
                                       latency_json("udp_echo", udp_us)};
  for (const std::string& line : lines) std::printf("%s\n", line.c_str());
  print_ratio("Fast DDS echo", step_us, echo_us);
  print_ratio("UDP echo", step_us, udp_us);
  if (!json_file.empty()) {
    std::ofstream file{json_file};
    for (const std::string& line : lines) file << line << '\n';
  }
  return 0;
}

}  // namespace
}  // namespace hybridtest::benchmarks

int main(int argc, char** argv) {
  using namespace hybridtest::benchmarks;
  if (const std::optional<int> code = echo_peer_main(argc, argv)) return *code;
  CLI::App app{"Time of a coupled step, as a ratio to a plain Fast DDS echo and to a UDP echo, measured in one run"};
  EchoSettings settings;
  int rounds = 5;
  std::string json_file;
  app.add_option("--steps", settings.samples, "Number of measured steps and echoes per round")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--rounds", rounds, "Number of rounds")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--domain", settings.domain, "DDS domain")->check(CLI::Range(0, 232))->capture_default_str();
  app.add_option("--json", json_file, "Also write the three lines of JSON to this file");
  CLI11_PARSE(app, argc, argv);
  try {
    return run(rounds, settings, json_file);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "coupled_step: %s\n", error.what());
    return 1;
  }
}
