// control_loop_jitter [--seconds N] [--cpu N] [--domain N]
//
// Measures, in one run on one machine, the start lateness of the control periods of a site at 1024 Hz,
// beside the coordinator and the numerical substructure, and the wake-up lateness of cyclictest (Debian
// package rt-tests) at the same priority and nearly the same rate. Both are measured at the same time, so
// that other work on the machine affects both. The result is the ratio of their 99th percentiles: exit
// code 1 when it exceeds 2. Without cyclictest it prints a message and exits with 0.

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "benchmarks/cyclictest.hpp"
#include "core/child_process.hpp"
#include "recording/run_file_reader.hpp"

namespace hybridtest::benchmarks {
namespace {

constexpr int kPriority = 80;
constexpr double kRatioAtMost = 2.0;

void print(const char* what, const Lateness& lateness) {
  std::printf("{\"what\": \"%s\", \"p50_us\": %.1f, \"p99_us\": %.1f, \"max_us\": %.1f, \"count\": %lld}\n", what,
              lateness.p50_us, lateness.p99_us, lateness.max_us, lateness.count);
}

class Run {
 public:
  Run(int seconds, int cpu, unsigned domain)
      : seconds_{seconds},
        out_{std::filesystem::temp_directory_path() / ("control_loop_jitter_" + std::to_string(getpid()))} {
    std::filesystem::create_directories(out_);
    shared_ = {"--scenario",     HYBRIDTEST_SOURCE_DIR "/benchmarks/control_loop_jitter.yaml",
               "--set",          "time.duration_s=" + std::to_string(seconds),
               "--out",          out_.string(),
               "--domain",       std::to_string(domain),
               "--loopback-only"};
    if (cpu >= 0) {
      shared_.insert(shared_.end(), {"--set", "substructures[storey_1].real_time={priority: " +
                                                  std::to_string(kPriority) + ", cpu: " + std::to_string(cpu) + "}"});
    }
  }

  void measure(const std::filesystem::path& cyclictest, int cpu) {
    const std::filesystem::path programs{HYBRIDTEST_PROGRAM_DIR};
    start("coordinator", programs / "coordinator", shared_);
    start("storey_1", programs / "experimental_site", with_id("storey_1"));
    start("storey_2", programs / "numerical_substructure", with_id("storey_2"));
    std::vector<std::string> arguments{
        "--quiet",    "--mlockall", "--priority", std::to_string(kPriority), "--threads=1",
        "--interval", "977",        "--duration", std::to_string(seconds_),  "--histogram",
        "20000"};
    if (cpu >= 0) arguments.push_back("--affinity=" + std::to_string(cpu));
    start("cyclictest", cyclictest, arguments);
    for (const auto& child : children_) {
      while (child->is_running()) usleep(20'000);
      if (child->exit_code() != 0) {
        throw std::runtime_error{child->id() + " failed; see " + child->log_file().string()};
      }
    }
  }

  [[nodiscard]] Lateness cyclictest() const { return read_cyclictest(out_ / "cyclictest.log"); }
  [[nodiscard]] Lateness loop() const {
    const RunFileReader file{out_ / "storey_1.h5"};
    const auto value = [&](const char* column) { return file.column("loop_timing", column).at(0); };
    if (value("fifo_priority") != kPriority)
      std::printf("the control loop did not get SCHED_FIFO; see storey_1.log for the reason\n");
    std::printf("overruns %.0f, busy p99 %.1f us\n", value("overruns"), value("busy_p99_us"));
    return {.p50_us = value("start_lateness_p50_us"),
            .p99_us = value("start_lateness_p99_us"),
            .max_us = value("start_lateness_max_us"),
            .count = static_cast<long long>(value("starts"))};
  }
  void remove() const { std::filesystem::remove_all(out_); }

 private:
  void start(const std::string& id, const std::filesystem::path& program, const std::vector<std::string>& arguments) {
    children_.push_back(std::make_unique<ChildProcess>(
        id, ChildStart{.program = program, .arguments = arguments, .log_file = out_ / (id + ".log")}));
  }
  [[nodiscard]] std::vector<std::string> with_id(const char* id) const {
    std::vector<std::string> arguments = shared_;
    arguments.insert(arguments.end(), {"--id", id});
    return arguments;
  }

  int seconds_;
  std::filesystem::path out_;
  std::vector<std::string> shared_;
  std::vector<std::unique_ptr<ChildProcess>> children_;
};

int run(int seconds, int cpu, unsigned domain) {
  const std::filesystem::path cyclictest = cyclictest_program();
  if (cyclictest.empty()) {
    std::printf("skipped: cyclictest is not installed (Debian package rt-tests)\n");
    return 0;
  }
  Run measured{seconds, cpu, domain};
  measured.measure(cyclictest, cpu);
  const Lateness loop = measured.loop();
  const Lateness yardstick = measured.cyclictest();
  print("control_loop", loop);
  print("cyclictest", yardstick);
  const double ratio = loop.p99_us / yardstick.p99_us;
  std::printf("99th percentile of the start lateness, control loop / cyclictest: %.2f (at most %.0f)\n", ratio,
              kRatioAtMost);
  measured.remove();
  return ratio <= kRatioAtMost ? 0 : 1;
}

}  // namespace
}  // namespace hybridtest::benchmarks

int main(int argc, char** argv) {
  CLI::App app{"Start lateness of the control periods of a site, compared with cyclictest in the same run"};
  int seconds = 60;
  int cpu = -1;
  unsigned domain = 97;
  app.add_option("--seconds", seconds, "Duration of the measurement in s")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app.add_option("--cpu", cpu, "Run both on this processor; default: any");
  app.add_option("--domain", domain, "DDS domain")->check(CLI::Range(0, 232))->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    return hybridtest::benchmarks::run(seconds, cpu, domain);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "control_loop_jitter: %s\n", error.what());
    return 2;
  }
}
