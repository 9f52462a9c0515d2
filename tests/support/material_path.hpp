#pragma once

#include <string>
#include <vector>

namespace hybridtest {

struct PathPoint {
  double displacement_m = 0.0;
  double velocity_m_per_s = 0.0;
  double force_n = 0.0;
};

/// The force of a material of OpenSees along a path, from tests/reference/law_`name`.csv: displacement, velocity where
/// the path has one, and force.
/// @throws std::runtime_error for a file that cannot be read.
[[nodiscard]] std::vector<PathPoint> read_material_path(const std::string& name);

}  // namespace hybridtest
