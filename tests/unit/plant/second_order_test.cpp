#include "plant/transfer_systems/second_order.hpp"

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
using Complex = std::complex<double>;

constexpr double kPeriod_s = 1e-3;

/// By partial fractions over the poles p and q; critically damped with its own limit.
double ramp_response(double omega, double damping_ratio, double time_s) {
  const double lag_s = 2.0 * damping_ratio / omega;
  if (damping_ratio == 1.0) return time_s - lag_s + (time_s + lag_s) * std::exp(-omega * time_s);
  const Complex root = std::sqrt(Complex{damping_ratio * damping_ratio - 1.0});
  const Complex p = omega * (-damping_ratio + root);
  const Complex q = omega * (-damping_ratio - root);
  const Complex transient = omega * omega / (p - q) * (std::exp(p * time_s) / (p * p) - std::exp(q * time_s) / (q * q));
  return time_s - lag_s + transient.real();
}

struct Case {
  double natural_frequency_hz;
  double damping_ratio;
};
constexpr Case kCases[] = {{15.0, 0.9}, {15.0, 0.02}, {15.0, 1.0}, {5.0, 3.0}, {200.0, 0.7}, {3000.0, 0.5}};

double omega_of(const Case& system) { return 2.0 * std::numbers::pi * system.natural_frequency_hz; }

SecondOrder actuator_of(const Case& system, Duration delay = Duration::zero()) {
  return SecondOrder{
      {.natural_frequency_hz = system.natural_frequency_hz, .damping_ratio = system.damping_ratio, .delay = delay},
      1ms};
}

TEST(SecondOrder, RampResponseMatchesClosedForm) {
  for (const Case& system : kCases) {
    SecondOrder actuator = actuator_of(system);
    for (int i = 0; i < 1000; ++i) {
      const double time_s = kPeriod_s * i;
      ASSERT_NEAR(actuator.step(time_s), ramp_response(omega_of(system), system.damping_ratio, time_s), 1e-12)
          << system.natural_frequency_hz << " Hz, " << system.damping_ratio;
    }
  }
}

TEST(SecondOrder, StepResponseMatchesClosedForm) {
  for (const Case& system : kCases) {
    SecondOrder actuator = actuator_of(system);
    const double omega = omega_of(system);
    for (int i = 0; i < 1000; ++i) {
      // The step rises over one period, from one ramp's begin to another's.
      const double rise = ramp_response(omega, system.damping_ratio, kPeriod_s * (i + 1)) -
                          ramp_response(omega, system.damping_ratio, kPeriod_s * i);
      ASSERT_NEAR(actuator.step(1.0), rise / kPeriod_s, 1e-11);  // rounding over the period
    }
  }
}

TEST(SecondOrder, IsExactForPiecewiseLinearCommandAndAnyDelay) {
  Random random{9};
  std::vector<double> command;
  for (int i = 0; i < 300; ++i) command.push_back(random.normal());
  for (const Case& system : kCases) {
    for (const Duration delay : {Duration{0}, Duration{4ms}, Duration{300us}, Duration{20480us}}) {
      SecondOrder actuator = actuator_of(system, delay);
      const auto expected = piecewise_linear_response(command, kPeriod_s, to_seconds(delay), [&](double time_s) {
        return ramp_response(omega_of(system), system.damping_ratio, time_s);
      });
      for (std::size_t i = 0; i < command.size(); ++i)
        ASSERT_NEAR(actuator.step(command[i]), expected[i], 1e-9);  // the sum of ramps cancels digits
    }
  }
}

TEST(SecondOrder, HasItsFrequencyResponse) {
  constexpr Case kActuator{15.0, 0.9};
  constexpr double kDelay_s = 0.004;
  for (const double frequency_hz : {1.0, 5.0, 15.0}) {
    SecondOrder actuator = actuator_of(kActuator, 4ms);
    const double omega = 2.0 * std::numbers::pi * frequency_hz;
    const double ratio = frequency_hz / kActuator.natural_frequency_hz;
    const Complex response =
        std::polar(1.0, -omega * kDelay_s) / Complex{1.0 - ratio * ratio, 2.0 * kActuator.damping_ratio * ratio};
    for (int i = 0; i < 3000; ++i) {
      const Complex phasor = std::polar(1.0, omega * kPeriod_s * i);
      const double displacement_m = actuator.step(phasor.imag());
      if (i < 1000) continue;  // transients have died out
      // Straight lines between samples lose (omega T)^2 / 12 of the amplitude.
      ASSERT_NEAR(displacement_m, (response * phasor).imag(), std::pow(omega * kPeriod_s, 2) / 12.0);
    }
  }
}

TEST(SecondOrder, ResetSetsRest) {
  SecondOrder actuator = actuator_of(kCases[0], 2500us);
  SecondOrder fresh = actuator_of(kCases[0], 2500us);
  for (int i = 0; i < 20; ++i) static_cast<void>(actuator.step(1.0));
  actuator.reset();
  for (int i = 0; i < 20; ++i) ASSERT_EQ(actuator.step(0.5), fresh.step(0.5));
}

TEST(SecondOrder, RejectsParametersOutOfRange) {
  const auto make = [](double frequency_hz, double damping_ratio, Duration delay, Duration period) {
    return SecondOrder{{.natural_frequency_hz = frequency_hz, .damping_ratio = damping_ratio, .delay = delay}, period};
  };
  EXPECT_NO_THROW(make(15.0, 0.9, 4ms, 1ms));
  EXPECT_THROW(make(0.0, 0.9, 4ms, 1ms), ConfigError);
  EXPECT_THROW(make(20'000.0, 0.9, 4ms, 1ms), ConfigError);
  EXPECT_THROW(make(15.0, 0.0, 4ms, 1ms), ConfigError);
  EXPECT_THROW(make(15.0, 11.0, 4ms, 1ms), ConfigError);
  EXPECT_THROW(make(15.0, 0.9, -4ms, 1ms), ConfigError);
  EXPECT_THROW(make(15.0, 0.9, 4ms, 0ms), ConfigError);
  EXPECT_THROW(make(std::nan(""), 0.9, 4ms, 1ms), ConfigError);
}

}  // namespace
}  // namespace hybridtest
