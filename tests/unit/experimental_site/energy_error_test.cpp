#include "experimental_site/energy_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

constexpr double kStiffness = 2.0e6;
constexpr double kAmplitude = 0.03;
constexpr double kOmega = 8.0;

/// An elastic specimen that follows a sine late by `delay_s`, over whole cycles.
EnergyErrorMonitor after_cycles(double delay_s, int cycles) {
  EnergyErrorMonitor monitor{SiteMatrix::Constant(1, 1, kStiffness), 1e-3};
  constexpr int kSamples = 2000;
  const double period_s = 2.0 * std::numbers::pi / kOmega / kSamples;
  for (int i = 0; i <= cycles * kSamples; ++i) {
    const double time_s = i * period_s;
    const double target = kAmplitude * std::sin(kOmega * time_s);
    const double measured = kAmplitude * std::sin(kOmega * (time_s - delay_s));
    monitor.sample(SiteVector::Constant(1, target), SiteVector::Constant(1, measured),
                   SiteVector::Constant(1, kStiffness * measured));
  }
  return monitor;
}

TEST(EnergyErrorTest, IsTheWorkOfADelayOverACycle) {
  // f = k X sin(w(t - tau)), x_target = X sin(wt): the integral of f dx_target over a cycle is
  // -pi k X^2 sin(w tau), that of f dx_measured is zero. The trapezoidal rule over whole cycles
  // of a sine is exact up to (pi/N)^2/..., here 1e-6.
  const double delay_s = 0.02;
  const double exact = -3 * std::numbers::pi * kStiffness * kAmplitude * kAmplitude * std::sin(kOmega * delay_s);
  const EnergyErrorMonitor monitor = after_cycles(delay_s, 3);
  EXPECT_NEAR(monitor.energy_error_j(), exact, 2e-6 * std::abs(exact));
  EXPECT_NEAR(monitor.ratio(), exact / (0.5 * kStiffness * kAmplitude * kAmplitude), 2e-5);
}

TEST(EnergyErrorTest, IsZeroWithoutTrackingError) { EXPECT_NEAR(after_cycles(0.0, 3).ratio(), 0.0, 1e-12); }

TEST(EnergyErrorTest, IsPositiveWhenTheActuatorLeads) { EXPECT_GT(after_cycles(-0.02, 3).ratio(), 1.0); }

TEST(EnergyErrorTest, RejectsStiffnessThatCannotScale) {
  EXPECT_THROW((EnergyErrorMonitor{SiteMatrix::Zero(1, 1), 1e-3}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
