#include "recording/summary/percentiles.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace hybridtest {
namespace {

std::size_t nearest_rank(std::size_t count, std::size_t percent) {
  return std::max<std::size_t>((count * percent + 99) / 100, 1) - 1;
}

}  // namespace

PercentileSearch::PercentileSearch()
    : values_{[](std::size_t count) {
        return std::vector<std::size_t>{nearest_rank(count, 50), nearest_rank(count, 99), count - 1};
      }} {}

void PercentileSearch::add(double value) {
  if (std::isfinite(value)) values_.add(value);
}

std::optional<Percentiles> PercentileSearch::result() const {
  const std::vector<double>& values = values_.values();
  if (values.empty()) return {};
  return Percentiles{values[0], values[1], values[2]};
}

std::optional<Percentiles> percentiles(const std::vector<double>& values) {
  PercentileSearch search;
  do {
    for (const double value : values) search.add(value);
  } while (search.end_pass());
  return search.result();
}

}  // namespace hybridtest
