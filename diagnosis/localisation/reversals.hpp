#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace hybridtest {

/// A turn of the motion, found once it has come back by a threshold.
struct Reversal {
  std::size_t sample = 0;  // of the extreme
  double displacement_m = 0.0;
};

/// Extremes between which the motion goes by more than `threshold_m`, in order; maxima and minima in turn.
[[nodiscard]] std::vector<Reversal> reversals_of(std::span<const double> displacement_m, double threshold_m);

/// A threshold above what noise does: a fiftieth of the whole span.
[[nodiscard]] double reversal_threshold_m(std::span<const double> displacement_m);

/// |displacement - displacement at the last reversal| at every sample; before the first, from the start.
[[nodiscard]] std::vector<double> distance_since_reversal_m(std::span<const double> displacement_m,
                                                            const std::vector<Reversal>& reversals);

/// Whole cycles completed at every sample: two reversals each.
[[nodiscard]] std::vector<double> cycles_completed(std::size_t samples, const std::vector<Reversal>& reversals);

}  // namespace hybridtest
