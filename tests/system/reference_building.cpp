#include "tests/system/reference_building.hpp"

#include "tests/support/shared_data.hpp"

namespace hybridtest {

std::filesystem::path recorded_reference(const std::string& law) {
  return shared_data("reference/two_storey_" + law + ".csv");
}

std::filesystem::path reference_motion() { return shared_data("ground_motions/elcentro_1940_ns.AT2"); }

ReferenceDistance distance_from(const ReferenceHistory& reference, const RecordedRun& run) {
  const std::vector<double> floor_1_m = run.column("coordinator", "steps", "displacement_floor_1_m");
  const std::vector<double> floor_2_m = run.column("coordinator", "steps", "displacement_floor_2_m");
  ReferenceDistance distance;
  distance.samples = compared_samples(reference, floor_1_m.size());
  if (distance.samples == 0) return distance;
  distance.floor_1 = largest_share(reference.displacement_m.at(0), floor_1_m);
  distance.floor_2 = largest_share(reference.displacement_m.at(1), floor_2_m);
  return distance;
}

}  // namespace hybridtest
