#include "tests/support/reference_history.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace hybridtest {
namespace {

constexpr std::size_t kStepsPerSample = 10;

}  // namespace

ReferenceHistory read_reference(const std::filesystem::path& file) {
  std::ifstream stream{file};
  std::string line;
  if (!std::getline(stream, line)) throw std::runtime_error{"no reference history in " + file.string()};
  ReferenceHistory history;
  while (line.find("displacement_" + std::to_string(history.displacement_m.size() + 1) + "_m") != std::string::npos) {
    history.displacement_m.emplace_back();
  }
  if (history.displacement_m.empty()) throw std::runtime_error{"no displacements in " + file.string()};
  while (std::getline(stream, line)) {
    std::istringstream columns{line};
    double time_s = 0.0;
    columns >> time_s;
    for (std::vector<double>& displacement_m : history.displacement_m) {
      char comma = ',';
      double value_m = 0.0;
      if (!(columns >> comma >> value_m)) throw std::runtime_error{"a row is not complete in " + file.string()};
      displacement_m.push_back(value_m);
    }
  }
  return history;
}

std::filesystem::path committed_reference(const std::string& building) {
  return std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "tests" / "reference" / (building + ".csv");
}

double largest_share(const std::vector<double>& reference, const std::vector<double>& found) {
  double peak = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < reference.size() && (i + 1) * kStepsPerSample < found.size(); ++i) {
    peak = std::max(peak, std::abs(reference[i]));
    largest = std::max(largest, std::abs(found[(i + 1) * kStepsPerSample] - reference[i]));
  }
  return largest / peak;
}

std::size_t compared_samples(const ReferenceHistory& reference, std::size_t steps) {
  return steps == 0 ? 0 : std::min(reference.samples(), (steps - 1) / kStepsPerSample);
}

}  // namespace hybridtest
