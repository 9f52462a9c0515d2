#include "plant/transfer_systems/first_order.hpp"

#include <cmath>
#include <numbers>

#include "core/parameters/checked_parameter.hpp"

namespace hybridtest {

FirstOrder::FirstOrder(double time_constant_s, Duration control_period) {
  const double period_s = checked("control_period_s", to_seconds(control_period), kPositive);
  const Range range{.low = 1e-3 * period_s, .high = 1e6 * period_s};
  const double ratio = period_s / checked("time_constant_s", time_constant_s, range);
  const double mean_decay = -std::expm1(-ratio) / ratio;
  decay_ = std::exp(-ratio);
  weight_of_previous_ = mean_decay - decay_;
  weight_of_newest_ = 1.0 - mean_decay;
}

double FirstOrder::time_constant_s_at(double bandwidth_hz) {
  return 1.0 / (2.0 * std::numbers::pi * checked("bandwidth_hz", bandwidth_hz, kPositive));
}

double FirstOrder::step(double command_m) noexcept {
  displacement_m_ =
      decay_ * displacement_m_ + weight_of_previous_ * previous_command_m_ + weight_of_newest_ * command_m;
  previous_command_m_ = command_m;
  return displacement_m_;
}

void FirstOrder::reset() noexcept { displacement_m_ = previous_command_m_ = 0.0; }

}  // namespace hybridtest
