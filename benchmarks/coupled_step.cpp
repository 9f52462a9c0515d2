// coupled_step [--rounds N] [--steps N] [--busy-poll-us N] [--json FILE]
//
// Measures, in one run on one machine: the time of one coupled step (send the command, two substructures
// in their own processes answer, the integrator advances, the step is recorded, send the next command); a
// plain Fast DDS echo with the same payload, QoS and number of peers; and a plain UDP echo. They take
// turns, so that other work on the machine affects all of them. The results are the ratios, and a table
// of where the time of a step went. Beside them stands how late threads of this machine wake (cyclictest).

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>

#include "benchmarks/coupled_programs.hpp"
#include "benchmarks/cyclictest.hpp"
#include "benchmarks/echo.hpp"
#include "benchmarks/latency_report.hpp"
#include "benchmarks/traced_steps.hpp"
#include "core/child_process.hpp"

namespace hybridtest::benchmarks {
namespace {

/// Ordinary threads like ours, as long as the measurement takes.
class MachineJitter {
 public:
  explicit MachineJitter(const std::filesystem::path& program) {
    if (program.empty()) {
      std::printf("cyclictest is not installed (Debian package rt-tests): the jitter of the machine is not known\n");
      return;
    }
    log_ = std::filesystem::temp_directory_path() / ("coupled_step_jitter_" + std::to_string(::getpid()) + ".log");
    process_.emplace("cyclictest", ChildStart{.program = program,
                                              .arguments = {"--quiet", "--policy=other", "--threads=1",
                                                            "--interval=1000", "--histogram=20000"},
                                              .log_file = log_,
                                              .is_killed_with_parent = true});
  }

  void print() {
    if (!process_) return;
    process_->send_signal(SIGINT);  // it prints then
    static_cast<void>(process_->wait_for_end(std::chrono::seconds{5}));
    const Lateness lateness = read_cyclictest(log_);
    std::printf(
        "this machine wakes a thread late by (cyclictest, ordinary priority)   median %.0f us   "
        "99th percentile %.0f us   99.9th %.0f us\n",
        lateness.p50_us, lateness.p99_us, lateness.p999_us);
    std::filesystem::remove(log_);
  }

 private:
  std::filesystem::path log_;
  std::optional<ChildProcess> process_;
};

/// One quality of service.
struct Measured {
  std::vector<double> echo_us;
  std::vector<double> transport_us;
  StepTrace trace;
};

void append(std::vector<double>& all, const std::vector<double>& round) {
  all.insert(all.end(), round.begin(), round.end());
}

void append(StepTrace& all, StepTrace&& round) {
  if (all.stages_us.empty()) {
    all = std::move(round);
    return;
  }
  append(all.step_us, round.step_us);
  append(all.recording_us, round.recording_us);
  for (std::size_t i = 0; i < all.stages_us.size(); ++i) append(all.stages_us[i].second, round.stages_us[i].second);
}

void measure(EchoSettings settings, bool best_effort, Measured& measured) {
  settings.best_effort = best_effort;
  append(measured.echo_us, fast_dds_echo_us(settings));
  append(measured.transport_us, transport_echo_us(settings));
  append(measured.trace, traced_steps(settings));
}

void print_ratio(const std::string& what, const std::vector<double>& step_us, const std::vector<double>& yardstick_us) {
  const auto ratio = [&](double fraction) {
    return percentile_us(step_us, fraction) / percentile_us(yardstick_us, fraction);
  };
  std::printf("%-58s median %5.2f   99th percentile %5.2f   99.9th %5.2f\n", what.c_str(), ratio(0.5), ratio(0.99),
              ratio(0.999));
}

void print_stages(const char* quality, const StepTrace& trace) {
  std::printf("\nwhere the time of a step goes, %s [us]%*s median     mean     99th\n", quality,
              static_cast<int>(14 - std::string{quality}.size()), "");
  const auto line = [](const std::string& what, const std::vector<double>& times_us) {
    std::printf("  %-46s %8.2f %8.2f %8.2f\n", what.c_str(), percentile_us(times_us, 0.5), mean_us(times_us),
                percentile_us(times_us, 0.99));
  };
  for (const auto& [stage, times_us] : trace.stages_us) line(stage, times_us);
  line("the step", trace.step_us);
  line("recorded, while the substructures work", trace.recording_us);
}

int run(int rounds, const EchoSettings& settings, const std::string& json_file) {
  MachineJitter jitter{cyclictest_program()};
  std::vector<double> step_us;
  std::vector<double> udp_us;
  Measured reliable;
  Measured best_effort;
  const std::vector<std::string> further{
      "--set", "time.duration_s=" + std::to_string((settings.samples + settings.warm_up) * 1e-3), "--busy-poll-us",
      std::to_string(settings.busy_poll_us)};
  for (int round = 0; round < rounds; ++round) {
    std::fprintf(stderr, "round %d of %d\n", round + 1, rounds);
    append(step_us, coupled_step_us(HYBRIDTEST_SOURCE_DIR "/benchmarks/coupled_step.yaml", {"storey_1", "storey_2"},
                                    settings.warm_up, settings.domain, further));
    append(udp_us, udp_echo_us(settings));
    measure(settings, false, reliable);
    measure(settings, true, best_effort);
  }
  const std::vector<std::string> lines{latency_json("udp_echo", udp_us),
                                       latency_json("fast_dds_echo", reliable.echo_us),
                                       latency_json("transport_echo", reliable.transport_us),
                                       latency_json("coupled_step", step_us),
                                       latency_json("coupled_step_nodes", reliable.trace.step_us),
                                       latency_json("fast_dds_echo_best_effort", best_effort.echo_us),
                                       latency_json("transport_echo_best_effort", best_effort.transport_us),
                                       latency_json("coupled_step_nodes_best_effort", best_effort.trace.step_us)};
  for (const std::string& line : lines) std::printf("%s\n", line.c_str());
  print_stages("reliable", reliable.trace);
  print_stages("best effort", best_effort.trace);
  std::printf("\n");
  print_ratio("coupled step of the programs / Fast DDS echo", step_us, reliable.echo_us);
  print_ratio("coupled step of the programs / UDP echo", step_us, udp_us);
  print_ratio("nodes and transport, reliable / Fast DDS echo", reliable.trace.step_us, reliable.echo_us);
  print_ratio("nodes and transport, reliable / UDP echo", reliable.trace.step_us, udp_us);
  print_ratio("nodes and transport, best effort / Fast DDS echo of it", best_effort.trace.step_us, best_effort.echo_us);
  print_ratio("nodes and transport, best effort / UDP echo", best_effort.trace.step_us, udp_us);
  print_ratio("transport alone, reliable / Fast DDS echo", reliable.transport_us, reliable.echo_us);
  print_ratio("transport alone, best effort / Fast DDS echo of it", best_effort.transport_us, best_effort.echo_us);
  jitter.print();
  write_lines(json_file, lines);
  return 0;
}

}  // namespace
}  // namespace hybridtest::benchmarks

int main(int argc, char** argv) {
  using namespace hybridtest::benchmarks;
  if (const std::optional<int> code = echo_peer_main(argc, argv, traced_peer)) return *code;
  CLI::App app{"Time of a coupled step, as a ratio to a plain Fast DDS echo and to a UDP echo, measured in one run"};
  EchoSettings settings;
  int rounds = 5;
  std::string json_file;
  app.add_option("--steps", settings.samples, "Number of measured steps and echoes per round")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--rounds", rounds, "Number of rounds")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--receive", settings.receive,
                 "In the parts without the programs: the waiting thread receives itself, or a thread of Fast DDS")
      ->check(CLI::IsMember({"waiting", "thread"}))
      ->capture_default_str();
  app.add_option("--busy-poll-us", settings.busy_poll_us, "Our threads look at the socket for so long before sleeping")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  app.add_option("--domain", settings.domain, "DDS domain")->check(CLI::Range(0, 232))->capture_default_str();
  app.add_option("--json", json_file, "Also write the lines of JSON to this file");
  CLI11_PARSE(app, argc, argv);
  try {
    return run(rounds, settings, json_file);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "coupled_step: %s\n", error.what());
    return 1;
  }
}
