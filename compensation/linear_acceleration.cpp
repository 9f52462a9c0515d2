#include "compensation/linear_acceleration.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {
namespace {

std::size_t checked_spacing(const LinearAcceleration::Parameters& parameters, double control_period_s) {
  checked_control_period(control_period_s);
  const double wanted_s = parameters.point_spacing_s > 0.0 ? parameters.point_spacing_s : parameters.delay_s;
  const std::size_t spacing = checked_periods("point_spacing_s", std::max(wanted_s, control_period_s), control_period_s,
                                              1, "the accelerations of one point spacing are kept");
  const double delay_s_max = LinearAcceleration::kSpacingsAheadMax * static_cast<double>(spacing) * control_period_s;
  expect_in_range("delay_s", parameters.delay_s, {.low = 0.0, .high = delay_s_max * (1.0 + 1e-9)},
                  "an acceleration cannot be extrapolated further than 8 point spacings");
  return spacing;
}

}  // namespace

LinearAcceleration::LinearAcceleration(const Parameters& parameters, double control_period_s)
    : initial_delay_s_{checked(parameters).delay_s},
      spacing_{checked_spacing(parameters, control_period_s)},
      point_spacing_s_{static_cast<double>(spacing_) * control_period_s},
      accelerations_m_per_s2_{spacing_ + 1} {
  set_delay(initial_delay_s_);
}

double LinearAcceleration::command(const CompensatorInput& input) noexcept {
  const double newest_m_per_s2 = input.target_acceleration_m_per_s2;
  accelerations_m_per_s2_.push(newest_m_per_s2);
  const double slope = (newest_m_per_s2 - accelerations_m_per_s2_[spacing_]) / point_spacing_s_;
  const double predicted_m_per_s2 = newest_m_per_s2 + delay_s_ * slope;
  return input.target_m +
         delay_s_ * (input.target_velocity_m_per_s + delay_s_ / 6.0 * (2.0 * newest_m_per_s2 + predicted_m_per_s2));
}

void LinearAcceleration::reset() noexcept {
  accelerations_m_per_s2_.clear();
  set_delay(initial_delay_s_);
}

void LinearAcceleration::set_delay(double delay_s) noexcept {
  if (std::isfinite(delay_s)) delay_s_ = std::clamp(delay_s, 0.0, delay_s_max());
}

}  // namespace hybridtest
