// secured_step [--rounds N] [--steps N] [--json FILE]
//
// What encryption and permissions cost: the time of one coupled step of the programs (one coordinator and two
// substructures on this machine) with credentials over that without. Both take turns in one run. The result is the
// ratio.

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>

#include "benchmarks/coupled_programs.hpp"
#include "benchmarks/latency_report.hpp"
#include "core/child_process.hpp"

namespace hybridtest::benchmarks {
namespace {

const std::filesystem::path kScenario = HYBRIDTEST_SOURCE_DIR "/benchmarks/coupled_step.yaml";

struct SecuredSettings {
  int rounds = 5;
  int steps = 4000;
  int warm_up = 500;
  unsigned domain = 0;
  std::string json_file;
};

/// Credentials for the scenario, removed with it.
class TemporaryCredentials {
 public:
  TemporaryCredentials() {
    ChildProcess script{"make_credentials",
                        ChildStart{.program = HYBRIDTEST_SOURCE_DIR "/launch/security/make_credentials",
                                   .arguments = {kScenario.string(), "--out", folder_.string(), "--hybridtest",
                                                 HYBRIDTEST_PROGRAM_DIR "/hybridtest"},
                                   .log_file = log_}};
    while (script.is_running()) ::usleep(20'000);
    if (script.exit_code() != 0) throw std::runtime_error{"make_credentials failed; see " + log_.string()};
  }
  ~TemporaryCredentials() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
    std::filesystem::remove(log_, ignored);
  }
  TemporaryCredentials(const TemporaryCredentials&) = delete;
  TemporaryCredentials& operator=(const TemporaryCredentials&) = delete;

  [[nodiscard]] const std::filesystem::path& folder() const noexcept { return folder_; }

 private:
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("secured_step_" + std::to_string(::getpid()));
  const std::filesystem::path log_ = folder_.string() + ".log";
};

int run(const SecuredSettings& settings) {
  const TemporaryCredentials credentials;
  const std::vector<std::string> ids{"storey_1", "storey_2"};
  const std::vector<std::string> further{
      "--set", "time.duration_s=" + std::to_string((settings.steps + settings.warm_up) * 1e-3)};
  std::vector<double> plain_us;
  std::vector<double> secured_us;
  for (int round = 0; round < settings.rounds; ++round) {
    std::fprintf(stderr, "round %d of %d\n", round + 1, settings.rounds);
    const auto append = [&](std::vector<double>& all, const std::filesystem::path& folder) {
      const std::vector<double> times_us =
          coupled_step_us(kScenario, ids, settings.warm_up, settings.domain, further, folder);
      all.insert(all.end(), times_us.begin(), times_us.end());
    };
    append(plain_us, {});
    append(secured_us, credentials.folder());
  }
  const std::vector<std::string> lines{latency_json("coupled_step", plain_us),
                                       latency_json("coupled_step_secured", secured_us)};
  for (const std::string& line : lines) std::printf("%s\n", line.c_str());
  std::printf("coupled step with credentials / without   median %.2f   99th percentile %.2f\n",
              percentile_us(secured_us, 0.5) / percentile_us(plain_us, 0.5),
              percentile_us(secured_us, 0.99) / percentile_us(plain_us, 0.99));
  write_lines(settings.json_file, lines);
  return 0;
}

}  // namespace
}  // namespace hybridtest::benchmarks

int main(int argc, char** argv) {
  using namespace hybridtest::benchmarks;
  CLI::App app{"Time of a coupled step with credentials, as a ratio to that without, measured in one run"};
  SecuredSettings settings;
  app.add_option("--steps", settings.steps, "Number of measured steps per round")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--rounds", settings.rounds, "Number of rounds")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--domain", settings.domain, "DDS domain")->check(CLI::Range(0, 232))->capture_default_str();
  app.add_option("--json", settings.json_file, "Also write the lines of JSON to this file");
  CLI11_PARSE(app, argc, argv);
  try {
    return run(settings);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "secured_step: %s\n", error.what());
    return 1;
  }
}
