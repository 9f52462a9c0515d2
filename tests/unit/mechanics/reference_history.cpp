#include "tests/unit/mechanics/reference_history.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace hybridtest {

double ReferenceHistory::largest_force_n() const {
  double largest = 0.0;
  for (const double force : force_n) largest = std::max(largest, std::abs(force));
  return largest;
}

double ReferenceHistory::displacement_between(std::size_t i, double fraction) const {
  constexpr int kPoints = 6;
  const int last = static_cast<int>(displacement_m.size()) - 1;
  const int first = std::min(static_cast<int>(i) - 2, last - kPoints + 1);
  const double place = static_cast<double>(i) + fraction;
  double sum = 0.0;
  for (int j = first; j < first + kPoints; ++j) {
    double weight = j < 0 ? 0.0 : displacement_m[static_cast<std::size_t>(j)];
    for (int k = first; k < first + kPoints; ++k) {
      if (k != j) weight *= (place - k) / (j - k);
    }
    sum += weight;
  }
  return sum;
}

ReferenceHistory read_reference(const std::filesystem::path& file) {
  std::ifstream stream{file};
  std::string line;
  if (!std::getline(stream, line)) throw std::runtime_error{"no reference history in " + file.string()};
  const auto force_column =
      std::count(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(line.find("storey_force_1")), ',');
  ReferenceHistory history;
  history.displacement_m.push_back(0.0);
  history.force_n.push_back(0.0);
  while (std::getline(stream, line)) {
    std::istringstream columns{line};
    std::vector<double> value(static_cast<std::size_t>(force_column) + 1);
    char comma = ',';
    for (double& number : value) columns >> number >> comma;
    history.displacement_m.push_back(value[1]);
    history.force_n.push_back(value.back());
  }
  return history;
}

}  // namespace hybridtest
