#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace hybridtest {

struct RestStretch {
  std::size_t begin = 0;
  std::size_t count = 0;
};

/// Stretches of 0.2 s, side by side, in which the motion stays within a thousandth of its whole span.
[[nodiscard]] std::vector<RestStretch> rest_stretches(std::span<const double> motion_m, double period_s);

/// Largest minus smallest value; 0 of none.
[[nodiscard]] double span_of(std::span<const double> values);

}  // namespace hybridtest
