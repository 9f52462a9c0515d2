#include "recording/summary/percentiles.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace hybridtest {
namespace {

double nearest_rank(const std::vector<double>& sorted, std::size_t percent) {
  const std::size_t rank = (sorted.size() * percent + 99) / 100;
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

}  // namespace

std::optional<Percentiles> percentiles(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  return Percentiles{nearest_rank(values, 50), nearest_rank(values, 99), values.back()};
}

}  // namespace hybridtest
