#include "plant/effects/network/clock_drift.hpp"

#include <algorithm>
#include <cmath>

namespace hybridtest {
namespace {

constexpr double kLongest_s = 1.0;

}  // namespace

ClockDrift::ClockDrift(std::span<const double> values, double sample_period_s)
    : drift_ratio_{values[0]}, samples_(static_cast<std::size_t>(std::ceil(kLongest_s / sample_period_s)) + 2) {}

void ClockDrift::before(const StageSample& /*sample*/, Motion& target) noexcept {
  newest_ = newest_ + 1 == samples_.size() ? 0 : newest_ + 1;
  samples_[newest_] = target.displacement_m;
  const auto whole = static_cast<std::size_t>(lag_);
  const double part = lag_ - std::floor(lag_);
  const auto ago = [this](std::size_t count) {
    return samples_[newest_ >= count ? newest_ - count : newest_ + samples_.size() - count];
  };
  target.displacement_m = (1.0 - part) * ago(whole) + part * ago(whole + 1);
  lag_ = std::min(lag_ + drift_ratio_, static_cast<double>(samples_.size() - 2));
}

void ClockDrift::reset() noexcept {
  std::ranges::fill(samples_, 0.0);
  lag_ = 0.0;
}

}  // namespace hybridtest
