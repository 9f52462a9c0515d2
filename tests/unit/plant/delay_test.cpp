#include "plant/transfer_systems/delay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace hybridtest {
namespace {

using namespace std::chrono_literals;

TEST(Delay, DelaysRampExactly) {
  // 20 ms at 1024 Hz are 20.48 periods.
  const Duration period = from_seconds(1.0 / 1024.0);
  Delay actuator{20ms, period};
  for (int i = 0; i < 100; ++i) {
    const double time_s = i * to_seconds(period);
    const double measured_m = actuator.step(0.3 * time_s);
    if (i > 18 && i < 23) continue;  // the cubic rounds the corner where the ramp begins
    ASSERT_NEAR(measured_m, std::max(0.0, 0.3 * (time_s - 0.020)), 1e-16);
  }
}

TEST(Delay, DelaysSineWithinInterpolationError) {
  Delay actuator{12300us, 1ms};
  constexpr double kOmega = 2.0 * 3.14159265358979 * 5.0;
  for (int i = 0; i < 1000; ++i) {
    const double delayed = actuator.step(std::sin(kOmega * 1e-3 * i));
    if (i < 15) continue;
    // (1 + f) f (1 - f) (2 - f) (omega T)^4 / 24 at the fraction f = 0.3 of the interval; a straight line would be off
    // by f (1 - f) (omega T)^2 / 2, two thousand times as much.
    ASSERT_NEAR(delayed, std::sin(kOmega * (1e-3 * i - 0.0123)),
                1.3 * 0.3 * 0.7 * 1.7 * std::pow(kOmega * 1e-3, 4) / 24.0 * 1.01);
  }
}

TEST(Delay, ResetClearsTheCommand) {
  Delay actuator{2ms, 1ms};
  for (int i = 0; i < 10; ++i) static_cast<void>(actuator.step(1.0));
  actuator.reset();
  EXPECT_EQ(actuator.step(1.0), 0.0);
}

}  // namespace
}  // namespace hybridtest
