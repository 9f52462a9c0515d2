#include "compensation/conditional_adaptive_time_series.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "compensation/adaptive_time_series.hpp"
#include "tests/unit/compensation/second_order_actuator.hpp"

// What it has in common with the adaptive time series is tested there.

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 2048.0;

template <class Series>
Eigen::Vector3d after_tracking(Series&& series, SecondOrderActuator actuator) {
  double measured_m = 0.0;
  for (int i = 0; i < 6 * 2048; ++i) {
    CompensatorInput input;
    for (const double omega : {7.0, 23.0, 40.0}) {
      const double angle = omega * kPeriod_s * i;
      input.target_m += 3e-3 * std::sin(angle);
      input.target_velocity_m_per_s += 3e-3 * omega * std::cos(angle);
      input.target_acceleration_m_per_s2 -= 3e-3 * omega * omega * std::sin(angle);
    }
    input.measured_displacement_m = measured_m;
    measured_m = actuator.displacement_m;
    actuator.advance(series.command(input), kPeriod_s);
  }
  return series.coefficients();
}

TEST(ConditionalAdaptiveTimeSeries, KeepsCoefficientWhenUpdateIsOutOfRange) {
  TimeSeriesParameters parameters;
  parameters.a0_max = 1.1;
  const SecondOrderActuator actuator{1.2, 0.016, 1.1e-4};
  // The window's variant goes to the end of the range, this one stays where it began; the others learn.
  EXPECT_DOUBLE_EQ(after_tracking(AdaptiveTimeSeries{parameters, kPeriod_s}, actuator)(0), 1.1);
  const Eigen::Vector3d conditional = after_tracking(ConditionalAdaptiveTimeSeries{parameters, kPeriod_s}, actuator);
  EXPECT_EQ(conditional(0), 1.0);
  EXPECT_NEAR(conditional(1), 0.016, 1.5 * kPeriod_s);  // as explained with the adaptive time series
}

}  // namespace
}  // namespace hybridtest
