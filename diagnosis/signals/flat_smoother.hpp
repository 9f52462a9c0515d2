#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace hybridtest {

/// Weighted mean of the samples around each one. The weights are those of a normal distribution of deviation s, applied
/// again to what they leave, and once more (twicing: Tukey, Exploratory Data Analysis, 1977): the gain at a frequency
/// f, 1 - (1 - g)^3 with g = exp(-(2 pi f s)^2 / 2), is flat to the sixth order at low ones and falls so steeply at
/// high ones that the noise of a second derivative does not survive it. Zero phase; at the ends the weights of the
/// samples that there are.
class FlatSmoother {
 public:
  /// @param deviation   s in samples; 0 changes nothing.
  explicit FlatSmoother(double deviation);

  [[nodiscard]] std::vector<double> smooth(std::span<const double> values) const;
  /// Samples on either side that take part.
  [[nodiscard]] std::size_t reach() const noexcept { return weights_.size() - 1; }
  /// Share of white noise variance that smoothing leaves.
  [[nodiscard]] double noise_share() const noexcept;

 private:
  std::vector<double> weights_;  // of the sample itself and of those 1, 2, … beside it; their sum both ways is 1
};

}  // namespace hybridtest
