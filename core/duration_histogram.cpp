#include "core/duration_histogram.hpp"

#include <algorithm>
#include <bit>

namespace hybridtest {
namespace {

constexpr int kLinearBits = 4;  // below 16 ns each nanosecond has a bin of its own

int bin_of(std::uint64_t nanoseconds) noexcept {
  const int doublings = std::max(0, static_cast<int>(std::bit_width(nanoseconds)) - kLinearBits - 1);
  const auto within = static_cast<int>(nanoseconds >> static_cast<unsigned>(doublings));  // 0 to 31
  return std::min(doublings * DurationHistogram::kBinsPerDoubling + within, DurationHistogram::kBins - 1);
}

}  // namespace

void DurationHistogram::record(Duration duration) noexcept {
  const Duration counted = std::max(duration, Duration{0});
  ++counts_[static_cast<std::size_t>(bin_of(static_cast<std::uint64_t>(counted.count())))];
  ++count_;
  max_ = std::max(max_, counted);
}

Duration DurationHistogram::quantile(double share) const noexcept {
  const double wanted = share * static_cast<double>(count_);
  std::int64_t so_far = 0;
  for (int bin = 0; bin < kBins; ++bin) {
    so_far += count_in(bin);
    if (so_far > 0 && static_cast<double>(so_far) >= wanted) return std::min(begin_of(bin + 1) - Duration{1}, max_);
  }
  return max_;
}

Duration DurationHistogram::begin_of(int bin) noexcept {
  if (bin < 2 * kBinsPerDoubling) return Duration{bin};
  const int doublings = bin / kBinsPerDoubling - 1;
  const std::int64_t within = bin % kBinsPerDoubling + kBinsPerDoubling;
  return Duration{within << static_cast<unsigned>(doublings)};
}

}  // namespace hybridtest
