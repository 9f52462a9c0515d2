#pragma once

#include <filesystem>
#include <vector>

namespace hybridtest {

/// First storey of a recorded OpenSees run.
struct ReferenceHistory {
  double interval_s = 0.01;
  std::vector<double> displacement_m;  // at rest at time 0, then one per interval
  std::vector<double> force_n;

  [[nodiscard]] double largest_force_n() const;

  /// Displacement between sample `i` and the next, `fraction` of the interval on: the quintic
  /// polynomial through six neighbouring samples. A sample that a jump of the acceleration
  /// falls into is the less exact; at rest before time 0.
  [[nodiscard]] double displacement_between(std::size_t i, double fraction) const;
};

/// @param file   columns time_s, displacement_1_m … and storey_force_1_n or _N.
/// @throws std::runtime_error for a file that cannot be read.
[[nodiscard]] ReferenceHistory read_reference(const std::filesystem::path& file);

}  // namespace hybridtest
