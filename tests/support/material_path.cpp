#include "tests/support/material_path.hpp"

#include <fstream>
#include <stdexcept>

namespace hybridtest {

std::vector<PathPoint> read_material_path(const std::string& name) {
  const std::string path = std::string{HYBRIDTEST_SOURCE_DIR} + "/tests/reference/law_" + name + ".csv";
  std::ifstream stream{path};
  std::string head;
  if (!std::getline(stream, head)) throw std::runtime_error{"no path in " + path};
  const bool has_velocity = head.find("velocity") != std::string::npos;
  std::vector<PathPoint> points;
  PathPoint point;
  char comma = ',';
  while (stream >> point.displacement_m >> comma) {
    if (has_velocity) stream >> point.velocity_m_per_s >> comma;
    stream >> point.force_n;
    points.push_back(point);
  }
  return points;
}

}  // namespace hybridtest
