#include <cstdio>
#include <cstring>
#include <exception>
#include <map>
#include <string>

#include "core/exit_code.hpp"
#include "runtime/simulation.hpp"
#include "scenario/scenario.hpp"
#include "scenario/scenario_digest.hpp"

namespace hybridtest {
namespace {

/// Keeps the bytes of every row.
class RowBytes final : public RowSink {
 public:
  void append(std::span<const double> row) noexcept override {
    const std::size_t end = bytes_.size();
    bytes_.resize(end + row.size_bytes());
    std::memcpy(bytes_.data() + end, row.data(), row.size_bytes());
  }
  [[nodiscard]] const std::string& bytes() const noexcept { return bytes_; }

 private:
  std::string bytes_;
};

void print_digests(const std::filesystem::path& file, const std::string& override_text) {
  const Scenario scenario = read_scenario(file, {override_text});
  std::map<std::string, RowBytes> records;
  SimulationObserver observer;
  observer.sink = [&](const std::string& participant, const TableLayout& table) -> RowSink& {
    return records[participant + "/" + table.name];
  };
  SimulationSettings settings;
  settings.seed = 1;
  settings.network.latency = std::chrono::microseconds{50};
  const SimulationResult result = simulate(scenario, settings, observer);
  std::printf("%s: %lld steps\n", scenario.name.c_str(), static_cast<long long>(result.coordinator.completed_steps));
  for (const auto& [name, record] : records) {
    std::printf("  %s ", name.c_str());
    for (const std::uint8_t byte : sha256(record.bytes())) std::printf("%02x", byte);
    std::printf("\n");
  }
}

}  // namespace
}  // namespace hybridtest

/// simulate_digest OVERRIDE SCENARIO…: the flags that this program was compiled with, and a SHA-256 of every record of
/// each scenario under simulated time.
int main(int argc, char** argv) try {
  std::printf("%s\n", HYBRIDTEST_COMPILED_WITH);
  for (int i = 2; i < argc; ++i) hybridtest::print_digests(argv[i], argv[1]);
  return hybridtest::kExitCompleted;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return hybridtest::kExitConfiguration;
}
