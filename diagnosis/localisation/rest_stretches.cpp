#include "diagnosis/localisation/rest_stretches.hpp"

#include <algorithm>
#include <cmath>

namespace hybridtest {
namespace {

constexpr double kRestSpan = 0.001;
constexpr double kLength_s = 0.2;

}  // namespace

double span_of(std::span<const double> values) {
  if (values.empty()) return 0.0;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

std::vector<RestStretch> rest_stretches(std::span<const double> motion_m, double period_s) {
  const auto length = std::max<std::size_t>(2, static_cast<std::size_t>(std::ceil(kLength_s / period_s)));
  const double allowed_m = kRestSpan * span_of(motion_m);
  std::vector<RestStretch> found;
  for (std::size_t begin = 0; begin + length <= motion_m.size(); begin += length) {
    if (span_of(motion_m.subspan(begin, length)) <= allowed_m) found.push_back({begin, length});
  }
  return found;
}

}  // namespace hybridtest
