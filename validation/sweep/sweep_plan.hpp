#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hybridtest {

/// One thing that varies from case to case.
struct Varied {
  std::string key;                  // of the scenario, as for --set; or a condition of the network, see below
  std::vector<std::string> values;  // as for --set
  bool operator==(const Varied&) const = default;
};

/// Stands in a value for the seed of the case.
inline constexpr std::string_view kSeedValue = "@seed";

/// A finite decimal number; nothing for any other text.
[[nodiscard]] std::optional<double> number_of(std::string_view text);

/// The substructure whose latency a key `site_latency_us[ID]` varies; nothing for any other key.
[[nodiscard]] std::optional<std::string> site_of_latency(std::string_view key);

/// Reads `key=a,b,c`, `key=low..high/count` (evenly spaced) or `key=low..high/count/log` (evenly spaced logarithms).
/// Commas inside brackets, braces and quotes do not separate values. Keys without a dot among `latency_us`,
/// `latency_spread`, `jitter_us`, `loss`, `duplication` and `reordering` are conditions of the simulated network, and
/// so is `site_latency_us[ID]`.
/// @throws ConfigError for a text of another form.
[[nodiscard]] Varied read_varied(std::string_view text);

/// Reads `first..last`, or one number.
/// @throws ConfigError for a text of another form, and for more than a million seeds.
[[nodiscard]] std::pair<std::uint64_t, std::uint64_t> read_seeds(std::string_view text);

/// One run of a sweep.
struct SweepCase {
  std::size_t number = 0;           // from 1
  std::vector<std::string> values;  // one for each Varied
  std::uint64_t seed = 0;
};

/// What a sweep runs. The same plan gives the same cases with the same numbers, whoever runs them and in what order.
struct SweepPlan {
  std::filesystem::path scenario_file;  // absolute
  std::string scenario_digest;          // without what varies: another file is not mixed in
  std::vector<std::string> overrides;   // of every case
  std::vector<Varied> varied;
  std::uint64_t first_seed = 1;
  std::uint64_t last_seed = 1;
  bool keeps_runs = false;
  bool operator==(const SweepPlan&) const = default;

  [[nodiscard]] std::size_t case_count() const noexcept;
  /// Every combination of values with every seed; the seed changes fastest, then the value of the last key.
  /// @param number   from 1 to case_count().
  [[nodiscard]] SweepCase case_at(std::size_t number) const;
  /// Arguments of `hybridtest` that run one case.
  [[nodiscard]] std::vector<std::string> arguments(const SweepCase& one, const std::filesystem::path& directory) const;
};

/// Files in the folder of a sweep.
struct SweepFiles {
  std::filesystem::path directory;

  [[nodiscard]] std::filesystem::path plan() const { return directory / "sweep.json"; }
  [[nodiscard]] std::filesystem::path jobs() const { return directory / "jobs.txt"; }
  [[nodiscard]] std::filesystem::path table() const { return directory / "table.csv"; }
  [[nodiscard]] std::filesystem::path page() const { return directory / "index.html"; }
  /// Summary of a case that is done; there when the case is done, and whole.
  [[nodiscard]] std::filesystem::path result(std::size_t number) const;
  /// Run directory of a case.
  [[nodiscard]] std::filesystem::path run(std::size_t number) const;
  [[nodiscard]] std::filesystem::path log(std::size_t number) const;
};

void write_plan(const SweepPlan& plan, const SweepFiles& files);
/// @throws ConfigError when there is none, or it cannot be read.
[[nodiscard]] SweepPlan read_plan(const SweepFiles& files);

}  // namespace hybridtest
