#include "diagnosis/localisation/gap_signals.hpp"

#include <numeric>

namespace hybridtest {

double mean_square(std::span<const double> values) noexcept {
  if (values.empty()) return 0.0;
  return std::inner_product(values.begin(), values.end(), values.begin(), 0.0) / static_cast<double>(values.size());
}

double variance(std::span<const double> values) noexcept {
  if (values.empty()) return 0.0;
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return sum / static_cast<double>(values.size());
}

}  // namespace hybridtest
