#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "validation/studies/rths_benchmark/benchmark_inputs.hpp"
#include "validation/studies/rths_benchmark/criteria.hpp"

namespace hybridtest::rths {

/// A test of launch/scenarios/rths_benchmark as it was run, over DDS or in simulated time.
struct RecordedRun {
  std::string directory;
  int case_number = 0;
  std::size_t motion = 0;
  int samples_per_step = 1;  // of 4096 Hz
  std::size_t steps = 0;     // that both coordinator and actuator recorded
  std::size_t steps_wanted = 0;
  Criteria criteria;
  Criteria in_process;                   // of the same case at the same rate, see run_in_process()
  std::uint64_t bridged = 0;             // steps completed without an answer of the actuator or of the frame
  double lateness_us_p99 = kNotANumber;  // of the site's control periods; not a number without a thread of its own
  double lateness_us_max = kNotANumber;

  [[nodiscard]] double rate_hz() const noexcept { return kSampleRateHz / samples_per_step; }
  [[nodiscard]] bool is_complete() const noexcept { return steps == steps_wanted; }
};

/// Reads a run directory: case and step by its scenario, motion by what was applied, signals by what coordinator and
/// actuator recorded.
/// @throws ConfigError when it is not a run of the benchmark, with what differs; RecordingError for unreadable files.
[[nodiscard]] RecordedRun read_recorded_run(const std::filesystem::path& directory, const BenchmarkInputs& inputs);

/// Our compensator in the study's own loop, nominal plant, with sensor noise, coupled at the rate of a run.
/// @param samples_per_exchange   of 4096 Hz, from 1.
/// @param exchanges              from 2; at most as the motion has.
[[nodiscard]] Criteria run_in_process(const BenchmarkInputs& inputs, int case_number, std::size_t motion,
                                      int samples_per_exchange, std::size_t exchanges);

/// A row for each run, below it the same case in process at the same rate, and as published.
[[nodiscard]] std::string recorded_markdown(std::span<const RecordedRun> runs);
/// For programs.
[[nodiscard]] std::string recorded_csv(std::span<const RecordedRun> runs);

}  // namespace hybridtest::rths
