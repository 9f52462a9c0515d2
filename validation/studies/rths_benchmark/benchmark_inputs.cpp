#include "validation/studies/rths_benchmark/benchmark_inputs.hpp"

#include <cstdlib>

#include "coordinator/excitation/read_ground_motion.hpp"
#include "core/config_error.hpp"

namespace hybridtest::rths {

BenchmarkInputs::BenchmarkInputs(const std::filesystem::path& ground_motions) {
  std::vector<ConfigIssue> issues;
  for (const char* name : kMotionNames) {
    const std::filesystem::path file = ground_motions / (std::string{"rths_benchmark_"} + name + ".csv");
    try {
      motions_.push_back(read_ground_motion(file, {.scale = kMotionScale, .unit = {}, .dt_s = {}}));
    } catch (const ConfigError& error) {
      issues.push_back({.file = "", .line = 0, .column = 0, .what = error.what()});
    }
  }
  if (!issues.empty()) {
    issues.push_back({.file = "",
                      .line = 0,
                      .column = 0,
                      .what =
                          "the benchmark takes its three ground motions from the directory that --ground-motions or "
                          "HYBRIDTEST_GROUND_MOTIONS names"});
    throw ConfigError{std::move(issues)};
  }
  for (int case_number = 1; case_number <= kCases; ++case_number) {
    for (const GroundMotion& motion : motions_) references_.push_back(make_reference(case_number, motion));
  }
}

std::filesystem::path ground_motion_directory(const std::filesystem::path& given) {
  if (!given.empty()) return given;
  const char* from_environment = std::getenv("HYBRIDTEST_GROUND_MOTIONS");
  if (from_environment != nullptr && *from_environment != '\0') return from_environment;
  throw ConfigError{
      "the directory with the ground motions of the benchmark is not known: give --ground-motions DIR or set "
      "HYBRIDTEST_GROUND_MOTIONS; expected in it: rths_benchmark_elcentro.csv, rths_benchmark_kobe.csv, "
      "rths_benchmark_morgan.csv"};
}

}  // namespace hybridtest::rths
