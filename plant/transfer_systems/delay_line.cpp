#include "plant/transfer_systems/delay_line.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "core/config_error.hpp"
#include "core/parameters/checked_parameter.hpp"

namespace hybridtest {
namespace {

constexpr std::int64_t kMaxIntervals = 100'000;

}  // namespace

DelayLine::DelayLine(Duration delay, Duration control_period) {
  const Range up_to_limit{.low = 0.0, .high = static_cast<double>(kMaxIntervals) * to_seconds(control_period)};
  static_cast<void>(checked("control_period_s", to_seconds(control_period), kPositive));
  static_cast<void>(checked("delay_s", to_seconds(delay), up_to_limit));
  whole_intervals_ = static_cast<std::size_t>(delay / control_period);
  fraction_ = to_seconds(delay % control_period) / to_seconds(control_period);
  samples_.assign(whole_intervals_ + 3, 0.0);
}

DelayLine::DelayLine(double delay_s, double period_s) {
  static_cast<void>(checked("control_period_s", period_s, kPositive));
  const Range up_to_limit{.low = 0.0, .high = static_cast<double>(kMaxIntervals) * period_s};
  const double intervals = checked("delay_s", delay_s, up_to_limit) / period_s;
  whole_intervals_ = static_cast<std::size_t>(intervals);
  fraction_ = intervals - std::floor(intervals);
  samples_.assign(whole_intervals_ + 3, 0.0);
}

void DelayLine::push(double value) noexcept {
  newest_ = newest_ + 1 == samples_.size() ? 0 : newest_ + 1;
  samples_[newest_] = value;
}

void DelayLine::reset() noexcept { std::fill(samples_.begin(), samples_.end(), 0.0); }

double DelayLine::delayed() const noexcept {
  return (1.0 - fraction_) * ago(whole_intervals_) + fraction_ * ago(whole_intervals_ + 1);
}

double DelayLine::delayed_smoothly() const noexcept {
  const double f = fraction_;
  if (whole_intervals_ > 0) {
    const double inside =
        0.5 * (1.0 - f) * (2.0 - f) * ago(whole_intervals_) + 0.5 * f * (2.0 - f) * ago(whole_intervals_ + 1);
    const double outside = (2.0 - f) * ago(whole_intervals_ - 1) + (1.0 + f) * ago(whole_intervals_ + 2);
    return (1.0 + f) * inside - f * (1.0 - f) / 6.0 * outside;
  }
  return 0.5 * (1.0 - f) * (2.0 - f) * ago(whole_intervals_) + f * (2.0 - f) * ago(whole_intervals_ + 1) -
         0.5 * f * (1.0 - f) * ago(whole_intervals_ + 2);
}

double DelayLine::corner() const noexcept { return ago(whole_intervals_ + 1); }

double DelayLine::ago(std::size_t intervals) const noexcept {
  return samples_[newest_ >= intervals ? newest_ - intervals : newest_ + samples_.size() - intervals];
}

}  // namespace hybridtest
