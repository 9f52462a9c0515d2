#include "compensation/delay_estimators/zero_crossing_slope.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {
namespace {

std::size_t checked_window(const ZeroCrossingSlope::Parameters& parameters, double control_period_s) {
  return std::max<std::size_t>(
      checked_periods("average_s", checked(parameters).average_s, control_period_s, 0, "it is an average of samples"),
      1);
}

}  // namespace

bool ZeroCrossingSlope::Channel::advance(double value, double period_s, double swing_m_min) noexcept {
  samples.push(value);
  double sum = 0.0;
  for (std::size_t age = 0; age < samples.capacity(); ++age) sum += samples[age];
  const double before_m = average_m;
  average_m = sum / static_cast<double>(samples.capacity());
  if (!has_average) {
    has_average = true;
    return false;
  }
  const bool has_crossed = (before_m < 0.0) != (average_m < 0.0);
  const double swing_before_m = swing_m;
  swing_m = has_crossed ? std::abs(average_m) : std::max(swing_m, std::abs(average_m));
  if (!has_crossed || swing_before_m < swing_m_min) return false;
  slope_m_per_s = (average_m - before_m) / period_s;
  fraction = average_m / (average_m - before_m);
  return true;
}

void ZeroCrossingSlope::Channel::reset() noexcept {
  samples.clear();
  average_m = swing_m = slope_m_per_s = fraction = 0.0;
  has_average = false;
}

ZeroCrossingSlope::ZeroCrossingSlope(const Parameters& parameters, double control_period_s)
    : DelayEstimator{parameters.limits, control_period_s},
      slope_m_per_s_min_{parameters.slope_m_per_s_min},
      motion_m_min_{parameters.motion_m_min},
      crossing_weight_{parameters.crossing_weight},
      reference_{checked_window(parameters, control_period_s)},
      measured_{reference_.samples.capacity()} {}

void ZeroCrossingSlope::observe(const DelaySample& sample) noexcept {
  for (std::size_t i = 0; i < known_; ++i) crossings_[i].age_periods += 1.0;
  if (reference_.advance(sample.reference_m, control_period_s(), motion_m_min_)) remember_reference_crossing();
  if (measured_.advance(sample.measured_displacement_m, control_period_s(), motion_m_min_)) compare_measured_crossing();
}

void ZeroCrossingSlope::remember_reference_crossing() noexcept {
  crossings_[next_] = {reference_.fraction, reference_.slope_m_per_s > 0.0};
  next_ = next_ + 1 == kCrossings ? 0 : next_ + 1;
  known_ = std::min(known_ + 1, kCrossings);
}

void ZeroCrossingSlope::compare_measured_crossing() noexcept {
  if (std::abs(measured_.slope_m_per_s) < slope_m_per_s_min_) return;
  const bool is_rising = measured_.slope_m_per_s > 0.0;
  // A delay outside its bounds is to be found at the bound, not to be overlooked.
  const double tolerance_s = 0.25 * (limits().delay_s_max - limits().delay_s_min);
  bool is_found = false;
  double nearest_s = 0.0;
  for (std::size_t i = 0; i < known_; ++i) {
    if (crossings_[i].is_rising != is_rising) continue;
    const double delay_s = (crossings_[i].age_periods - measured_.fraction) * control_period_s();
    if (delay_s < limits().delay_s_min - tolerance_s || delay_s > limits().delay_s_max + tolerance_s) continue;
    if (is_found && std::abs(delay_s - believed_s()) >= std::abs(nearest_s - believed_s())) continue;
    nearest_s = delay_s;
    is_found = true;
  }
  if (!is_found) return;
  const double within_s = std::clamp(nearest_s, limits().delay_s_min, limits().delay_s_max);
  believe(believed_s() + crossing_weight_ * (within_s - believed_s()));
}

void ZeroCrossingSlope::forget() noexcept {
  reference_.reset();
  measured_.reset();
  next_ = known_ = 0;
}

}  // namespace hybridtest
