#pragma once

#include <array>
#include <cstdint>

#include "core/time.hpp"

namespace hybridtest {

/// Counts durations in logarithmic bins: 16 per doubling, so the width of a bin is at most a
/// sixteenth of its durations. From 1 ns to 18 minutes; longer durations count as 18 minutes.
/// After construction it neither allocates nor computes in floating point: real-time safe.
class DurationHistogram {
 public:
  static constexpr int kBinsPerDoubling = 16;
  static constexpr int kBins = (40 - 4 + 1) * kBinsPerDoubling;

  /// Negative durations count as 0.
  void record(Duration duration) noexcept;

  [[nodiscard]] std::int64_t count() const noexcept { return count_; }
  /// Exactly; zero when nothing was recorded.
  [[nodiscard]] Duration max() const noexcept { return max_; }
  /// The upper end of the bin below which this share of all durations lies, or max() if that is less.
  /// @param share   0 to 1.
  [[nodiscard]] Duration quantile(double share) const noexcept;

  [[nodiscard]] std::int64_t count_in(int bin) const noexcept { return counts_[static_cast<std::size_t>(bin)]; }
  /// Bins hold durations from their begin to below that of the next.
  [[nodiscard]] static Duration begin_of(int bin) noexcept;

 private:
  std::array<std::int64_t, kBins> counts_{};
  std::int64_t count_ = 0;
  Duration max_{};
};

}  // namespace hybridtest
