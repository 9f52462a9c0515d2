#include "compensation/delay_estimator.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {
namespace {

DelayLimits checked_bounds(const DelayLimits& limits) {
  expect_in_range("delay_s_max", checked(limits).delay_s_max,
                  {.low = limits.delay_s_min, .high = 1.0, .low_open = true}, "a range ends above its beginning");
  expect_in_range("initial_delay_s", limits.initial_delay_s, {.low = limits.delay_s_min, .high = limits.delay_s_max},
                  "the estimate starts inside its own bounds");
  return limits;
}

}  // namespace

DelayEstimator::DelayEstimator(const DelayLimits& limits, double control_period_s)
    : limits_{checked_bounds(limits)},
      control_period_s_{checked_control_period(control_period_s)},
      believed_s_{limits.initial_delay_s},
      delay_s_{limits.initial_delay_s} {}

double DelayEstimator::estimate(const DelaySample& sample) noexcept {
  if (std::isfinite(sample.reference_m) && std::isfinite(sample.measured_displacement_m)) observe(sample);
  const double wanted_s = std::clamp(believed_s_ + network_latency_s_, limits_.delay_s_min, limits_.delay_s_max);
  const double step_s = limits_.rate_s_per_s_max * control_period_s_;
  delay_s_ += std::clamp(wanted_s - delay_s_, -step_s, step_s);
  return delay_s_;
}

void DelayEstimator::set_network_latency(double latency_s) noexcept {
  if (std::isfinite(latency_s) && latency_s >= 0.0) network_latency_s_ = latency_s;
}

void DelayEstimator::reset() noexcept {
  believed_s_ = delay_s_ = limits_.initial_delay_s;
  network_latency_s_ = 0.0;
  forget();
}

}  // namespace hybridtest
