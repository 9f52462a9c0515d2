#pragma once

#include <optional>
#include <vector>

#include "recording/summary/ranked_values.hpp"

namespace hybridtest {

/// Nearest-rank percentiles: each is a value that occurred, no more than the given share of all
/// values being smaller.
struct Percentiles {
  double p50 = 0.0;
  double p99 = 0.0;
  double max = 0.0;
};

/// Of values that do not fit into memory, handed over in passes as RankedValues needs them. Non-finite values are
/// ignored.
class PercentileSearch {
 public:
  PercentileSearch();

  void add(double value);
  /// Ends a pass. @return whether another one is needed.
  bool end_pass() { return values_.end_pass(); }
  /// After the last pass; nothing when no value was finite.
  [[nodiscard]] std::optional<Percentiles> result() const;

 private:
  RankedValues values_;
};

/// Non-finite values are ignored. @return nothing when no value remains.
[[nodiscard]] std::optional<Percentiles> percentiles(const std::vector<double>& values);

}  // namespace hybridtest
