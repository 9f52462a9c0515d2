#pragma once

#include <filesystem>

#include "tests/support/shared_data.hpp"

namespace hybridtest {

/// The benchmark's motions, which are not part of this repository.
inline std::filesystem::path benchmark_motions() { return shared_data("ground_motions"); }

#define HYBRIDTEST_NEEDS_BENCHMARK_MOTIONS() HYBRIDTEST_NEEDS_DATA(benchmark_motions() / "rths_benchmark_elcentro.csv")

}  // namespace hybridtest
