#pragma once

#include <filesystem>

namespace hybridtest::benchmarks {

/// How late threads start that wait for a time.
struct Lateness {
  double p50_us = 0.0;
  double p99_us = 0.0;
  double p999_us = 0.0;
  double max_us = 0.0;
  long long count = 0;
};

/// cyclictest of the Debian package rt-tests; empty where it is not installed.
[[nodiscard]] std::filesystem::path cyclictest_program();

/// From the histogram that cyclictest printed into the file.
/// @throws std::runtime_error when there is none.
[[nodiscard]] Lateness read_cyclictest(const std::filesystem::path& log);

}  // namespace hybridtest::benchmarks
