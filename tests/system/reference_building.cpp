#include "tests/system/reference_building.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace hybridtest {
namespace {

constexpr std::size_t kStepsPerSample = 10;

double largest_share(const std::vector<double>& reference, const std::vector<double>& found, std::size_t samples) {
  double peak = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < samples; ++i) {
    peak = std::max(peak, std::abs(reference[i]));
    largest = std::max(largest, std::abs(found[(i + 1) * kStepsPerSample] - reference[i]));
  }
  return largest / peak;
}

}  // namespace

ReferenceHistory read_reference(const std::string& law) {
  ReferenceHistory history;
  std::ifstream file{std::string{HYBRIDTEST_SHARED_DATA} + "/reference/two_storey_" + law + ".csv"};
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream columns{line};
    double time_s = 0.0;
    double floor_1_m = 0.0;
    double floor_2_m = 0.0;
    char comma = ',';
    columns >> time_s >> comma >> floor_1_m >> comma >> floor_2_m;
    history.floor_1_m.push_back(floor_1_m);
    history.floor_2_m.push_back(floor_2_m);
  }
  return history;
}

std::filesystem::path reference_motion() {
  return std::filesystem::path{HYBRIDTEST_SHARED_DATA} / "ground_motions" / "elcentro_1940_ns.AT2";
}

ReferenceDistance distance_from(const ReferenceHistory& reference, const RecordedRun& run) {
  const std::vector<double> floor_1_m = run.column("coordinator", "steps", "displacement_floor_1_m");
  const std::vector<double> floor_2_m = run.column("coordinator", "steps", "displacement_floor_2_m");
  ReferenceDistance distance;
  if (floor_1_m.empty()) return distance;
  distance.samples = std::min(reference.floor_1_m.size(), (floor_1_m.size() - 1) / kStepsPerSample);
  distance.floor_1 = largest_share(reference.floor_1_m, floor_1_m, distance.samples);
  distance.floor_2 = largest_share(reference.floor_2_m, floor_2_m, distance.samples);
  return distance;
}

}  // namespace hybridtest
