#pragma once

#include <optional>
#include <vector>

namespace hybridtest {

/// Nearest-rank percentiles: each is a value that occurred, no more than the given share of all
/// values being smaller.
struct Percentiles {
  double p50 = 0.0;
  double p99 = 0.0;
  double max = 0.0;
};

/// Non-finite values are ignored. @return nothing when no value remains.
[[nodiscard]] std::optional<Percentiles> percentiles(std::vector<double> values);

}  // namespace hybridtest
