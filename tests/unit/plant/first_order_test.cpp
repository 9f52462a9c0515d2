#include "plant/transfer_systems/first_order.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "core/config_error.hpp"
#include "core/random.hpp"
#include "tests/unit/plant/piecewise_linear_response.hpp"

namespace hybridtest {
namespace {

using namespace std::chrono_literals;

constexpr double kPeriod_s = 1e-3;

double ramp_response(double time_constant_s, double time_s) {
  return time_s + time_constant_s * std::expm1(-time_s / time_constant_s);
}

TEST(FirstOrder, RampResponseMatchesClosedForm) {
  for (const double time_constant_s : {1e-4, 5e-3, 2.0}) {
    FirstOrder actuator{time_constant_s, 1ms};
    for (int i = 0; i < 1000; ++i) {
      const double time_s = kPeriod_s * i;
      ASSERT_NEAR(actuator.step(time_s), ramp_response(time_constant_s, time_s), 1e-12);  // rounding
    }
  }
}

TEST(FirstOrder, StepResponseHasItsTimeConstant) {
  constexpr double kTimeConstant_s = 0.02;
  FirstOrder actuator{kTimeConstant_s, 1ms};
  double displacement_m = actuator.step(1.0);  // rises over the period before
  const double missing_m = 1.0 - displacement_m;
  for (int i = 1; i <= 300; ++i) {
    displacement_m = actuator.step(1.0);
    ASSERT_NEAR(displacement_m, 1.0 - missing_m * std::exp(-i * kPeriod_s / kTimeConstant_s), 1e-13);
  }
}

TEST(FirstOrder, IsExactForAnyPiecewiseLinearCommand) {
  Random random{8};
  std::vector<double> command;
  for (int i = 0; i < 400; ++i) command.push_back(random.normal());
  FirstOrder actuator{0.004, 1ms};
  const auto expected =
      piecewise_linear_response(command, kPeriod_s, 0.0, [](double time_s) { return ramp_response(0.004, time_s); });
  for (std::size_t i = 0; i < command.size(); ++i)
    ASSERT_NEAR(actuator.step(command[i]), expected[i], 1e-10);  // the sum of ramps cancels some digits
}

TEST(FirstOrder, IsThreeDecibelsDownAtBandwidth) {
  constexpr double kBandwidth_hz = 10.0;
  const double omega = 2.0 * std::numbers::pi * kBandwidth_hz;
  FirstOrder actuator{FirstOrder::time_constant_s_at(kBandwidth_hz), 1ms};
  const std::complex<double> response = 1.0 / std::complex<double>{1.0, 1.0};
  for (int i = 0; i < 3000; ++i) {
    const std::complex<double> phasor = std::polar(1.0, omega * kPeriod_s * i);
    const double displacement_m = actuator.step(phasor.imag());
    if (i < 1000) continue;  // transients have died out
    // Straight lines between samples lose (omega T)^2 / 12 of the amplitude.
    ASSERT_NEAR(displacement_m, (response * phasor).imag(), std::pow(omega * kPeriod_s, 2) / 12.0);
  }
}

TEST(FirstOrder, ResetSetsRest) {
  FirstOrder actuator{0.01, 1ms};
  FirstOrder fresh{0.01, 1ms};
  for (int i = 0; i < 10; ++i) static_cast<void>(actuator.step(1.0));
  actuator.reset();
  for (int i = 0; i < 10; ++i) ASSERT_EQ(actuator.step(0.5), fresh.step(0.5));
}

TEST(FirstOrder, RejectsParametersOutOfRange) {
  EXPECT_THROW((FirstOrder{0.0, 1ms}), ConfigError);
  EXPECT_THROW((FirstOrder{-1.0, 1ms}), ConfigError);
  EXPECT_THROW((FirstOrder{std::nan(""), 1ms}), ConfigError);
  EXPECT_THROW((FirstOrder{2e3, 1ms}), ConfigError);
  EXPECT_THROW((FirstOrder{0.01, 0ms}), ConfigError);
  EXPECT_THROW(static_cast<void>(FirstOrder::time_constant_s_at(0.0)), ConfigError);
}

}  // namespace
}  // namespace hybridtest
