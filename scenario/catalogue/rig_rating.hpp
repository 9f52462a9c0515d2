#pragma once

#include <limits>

namespace hybridtest {

/// What a rig can do at most, either way, in site time; infinite where it is not known.
struct RigRating {
  double displacement_m = std::numeric_limits<double>::infinity();
  double velocity_m_per_s = std::numeric_limits<double>::infinity();
  double force_n = std::numeric_limits<double>::infinity();
};

}  // namespace hybridtest
