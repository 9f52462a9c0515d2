#pragma once

#include <gtest/gtest.h>

#include <filesystem>

namespace hybridtest {

/// The benchmark's motions, which are not part of this repository.
inline std::filesystem::path benchmark_motions() {
  return std::filesystem::path{HYBRIDTEST_SHARED_DATA} / "ground_motions";
}

inline bool has_benchmark_motions() {
  return std::filesystem::exists(benchmark_motions() / "rths_benchmark_elcentro.csv");
}

#define SKIP_WITHOUT_BENCHMARK_MOTIONS() \
  if (!has_benchmark_motions()) GTEST_SKIP() << "no ground motions of the benchmark in " << benchmark_motions()

}  // namespace hybridtest
