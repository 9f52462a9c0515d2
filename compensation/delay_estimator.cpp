#include "compensation/delay_estimator.hpp"

#include <algorithm>
#include <cmath>

#include "compensation/parameter_check.hpp"

namespace hybridtest {
namespace {

const DelayLimits& checked(const DelayLimits& limits) {
  constexpr const char* kMachine = "no transfer system of a hybrid test is later than a second";
  checked_parameter("delay_s_min", limits.delay_s_min, {0.0, 1.0}, "nothing answers before it is told");
  checked_parameter("delay_s_max", limits.delay_s_max, {limits.delay_s_min, 1.0, false}, kMachine);
  checked_parameter("initial_delay_s", limits.initial_delay_s, {limits.delay_s_min, limits.delay_s_max},
                    "the estimate starts inside its own bounds");
  checked_parameter("rate_s_per_s_max", limits.rate_s_per_s_max, {0.0, 1000.0, false},
                    "the estimate has to move, and without a limit it would jump");
  return limits;
}

}  // namespace

DelayEstimator::DelayEstimator(const DelayLimits& limits, double control_period_s)
    : limits_{checked(limits)},
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
