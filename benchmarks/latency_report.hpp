#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

namespace hybridtest::benchmarks {

/// The value that `fraction` of the times do not exceed (nearest rank).
/// @param times_us   not empty; taken by value to be sorted.
[[nodiscard]] inline double percentile_us(std::vector<double> times_us, double fraction) {
  std::sort(times_us.begin(), times_us.end());
  const auto rank = static_cast<std::size_t>(fraction * static_cast<double>(times_us.size()));
  return times_us[std::min(rank, times_us.size() - 1)];
}

[[nodiscard]] inline double mean_us(const std::vector<double>& times_us) {
  return std::accumulate(times_us.begin(), times_us.end(), 0.0) / static_cast<double>(times_us.size());
}

/// One line of JSON.
[[nodiscard]] inline std::string latency_json(const std::string& what, const std::vector<double>& times_us) {
  char line[400];
  std::snprintf(line, sizeof(line),
                "{\"what\": \"%s\", \"samples\": %zu, \"p50_us\": %.2f, \"p90_us\": %.2f, \"p99_us\": %.2f, "
                "\"p999_us\": %.2f, \"max_us\": %.2f}",
                what.c_str(), times_us.size(), percentile_us(times_us, 0.5), percentile_us(times_us, 0.9),
                percentile_us(times_us, 0.99), percentile_us(times_us, 0.999), percentile_us(times_us, 1.0));
  return line;
}

/// @param file   empty: none is written.
inline void write_lines(const std::string& file, const std::vector<std::string>& lines) {
  if (file.empty()) return;
  std::ofstream stream{file};
  for (const std::string& line : lines) stream << line << '\n';
}

}  // namespace hybridtest::benchmarks
