#include "benchmarks/cyclictest.hpp"

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace hybridtest::benchmarks {

std::filesystem::path cyclictest_program() {
  for (const char* path : {"/usr/bin/cyclictest", "/usr/sbin/cyclictest", "/usr/local/bin/cyclictest"}) {
    if (std::filesystem::exists(path)) return path;
  }
  return {};
}

// Lines of a latency in us and a count.
Lateness read_cyclictest(const std::filesystem::path& log) {
  std::vector<std::pair<long, long long>> bins;
  Lateness lateness;
  std::ifstream file{log};
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("# Max Latencies:")) lateness.max_us = std::stod(line.substr(line.find(':') + 1));
    std::istringstream words{line};
    long us = 0;
    long long count = 0;
    if (line.starts_with('#') || !(words >> us >> count)) continue;
    bins.emplace_back(us, count);
    lateness.count += count;
  }
  if (lateness.count == 0) throw std::runtime_error{"cyclictest gave no histogram; see " + log.string()};
  double so_far = 0.0;
  for (const auto& [us, count] : bins) {
    const auto count_all = static_cast<double>(lateness.count);
    if (so_far < 0.5 * count_all) lateness.p50_us = static_cast<double>(us);
    if (so_far < 0.99 * count_all) lateness.p99_us = static_cast<double>(us);
    if (so_far < 0.999 * count_all) lateness.p999_us = static_cast<double>(us);
    so_far += static_cast<double>(count);
  }
  return lateness;
}

}  // namespace hybridtest::benchmarks
