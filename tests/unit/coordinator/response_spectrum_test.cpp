#include "coordinator/excitation/response_spectrum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>

#include "coordinator/excitation/read_ground_motion.hpp"
#include "tests/support/shared_data.hpp"

namespace hybridtest {
namespace {

/// A hundredth of a period between two values hides at most this share of a peak: 1 - cos(pi/100).
constexpr double kBetweenValues = 5e-4;

double omega(double period_s) { return 2.0 * std::numbers::pi / period_s; }

TEST(ResponseSpectrum, RectangularPulseFollowsClosedForm) {
  constexpr double kPulse_s = 0.2;
  const GroundMotion pulse{.dt_s = 0.01, .start_s = 0.0, .acceleration_m_per_s2 = std::vector<double>(21, 2.0)};
  for (const double period_s : {0.05, 0.1, 0.3, 0.39, 0.5, 1.0, 3.0, 10.0}) {
    // Chopra, Dynamics of Structures, section 4.7: the peak is in the pulse, or in the free vibration after a short
    // one.
    const double amplification =
        kPulse_s >= 0.5 * period_s ? 2.0 : 2.0 * std::sin(std::numbers::pi * kPulse_s / period_s);
    const double expected_m = 2.0 / std::pow(omega(period_s), 2) * amplification;
    const SpectrumOrdinate found = spectrum_ordinate(pulse, period_s, 0.0);
    EXPECT_NEAR(found.displacement_m, expected_m, kBetweenValues * expected_m) << period_s;
    EXPECT_NEAR(found.pseudo_acceleration_m_per_s2, 2.0 * amplification, kBetweenValues * 2.0 * amplification);
    EXPECT_EQ(found.period_s, period_s);
  }
}

TEST(ResponseSpectrum, LongTestAfterTheMotionChangesNothing) {
  GroundMotion pulse{.dt_s = 0.01, .start_s = 0.0, .acceleration_m_per_s2 = {0.0, 2.0, -1.0, 0.0}};
  const SpectrumOrdinate alone = spectrum_ordinate(pulse, 3.0, 0.05);
  pulse.acceleration_m_per_s2.resize(5000, 0.0);
  const SpectrumOrdinate followed = spectrum_ordinate(pulse, 3.0, 0.05);
  EXPECT_EQ(followed.displacement_m, alone.displacement_m);
  EXPECT_EQ(followed.velocity_m_per_s, alone.velocity_m_per_s);
}

TEST(ResponseSpectrum, ResonanceReachesSteadyState) {
  constexpr double kPeriod_s = 0.8;
  constexpr double kRatio = 0.05;
  GroundMotion motion{.dt_s = 0.002, .start_s = 0.0, .acceleration_m_per_s2 = {}};
  for (int i = 0; i <= 30'000; ++i) motion.acceleration_m_per_s2.push_back(std::sin(omega(kPeriod_s) * 0.002 * i));
  const SpectrumOrdinate found = spectrum_ordinate(motion, kPeriod_s, kRatio);
  EXPECT_NEAR(found.pseudo_acceleration_m_per_s2, 1.0 / (2.0 * kRatio), 10.0 * kBetweenValues);
  EXPECT_NEAR(found.velocity_m_per_s, omega(kPeriod_s) * found.displacement_m, kBetweenValues * found.velocity_m_per_s);
}

TEST(ResponseSpectrum, FinerPointsOnTheSameLinesChangeNothing) {
  GroundMotion coarse{.dt_s = 0.02, .start_s = 0.0, .acceleration_m_per_s2 = {}};
  for (int i = 0; i < 400; ++i)
    coarse.acceleration_m_per_s2.push_back(std::sin(0.37 * i) + 0.6 * std::cos(1.1 * i * i));
  const GroundMotion fine{.dt_s = 0.001, .start_s = 0.0, .acceleration_m_per_s2 = coarse.sampled(0.001, 399 * 20)};
  for (const double period_s : {0.02, 0.2, 1.0, 7.0}) {
    const SpectrumOrdinate a = spectrum_ordinate(coarse, period_s, 0.05);
    const SpectrumOrdinate b = spectrum_ordinate(fine, period_s, 0.05);
    EXPECT_NEAR(a.displacement_m, b.displacement_m, 2.0 * kBetweenValues * b.displacement_m) << period_s;
    // The velocity has a kink at each point of the motion: its peaks are narrower.
    EXPECT_NEAR(a.velocity_m_per_s, b.velocity_m_per_s, 6.0 * kBetweenValues * b.velocity_m_per_s) << period_s;
  }
}

TEST(ResponseSpectrum, SmallStepsLoseNoDigits) {
  // At rest under a constant: u = -a/w^2 (1 - cos wt). The closed form of the recurrence fails here.
  const GroundMotion step{.dt_s = 1e-6, .start_s = 0.0, .acceleration_m_per_s2 = std::vector<double>(100'001, 1.0)};
  const double period_s = 10.0;
  // After 0.1 s of it the oscillator swings freely, with the velocity w u_max.
  const double expected_m = 2.0 / std::pow(omega(period_s), 2) * std::sin(std::numbers::pi * 0.1 / period_s);
  EXPECT_NEAR(spectrum_ordinate(step, period_s, 0.0).displacement_m, expected_m, 1e-6 * expected_m);
}

TEST(ResponseSpectrum, PeriodsGoFromTwoHundredthsToTenSeconds) {
  const std::vector<double> periods_s = spectrum_periods_s();
  EXPECT_EQ(periods_s.size(), 101U);
  EXPECT_DOUBLE_EQ(periods_s.front(), 0.02);
  EXPECT_DOUBLE_EQ(periods_s.back(), 10.0);
  EXPECT_TRUE(std::ranges::is_sorted(periods_s));
}

/// Largest displacement by the classical Runge-Kutta method, with a two-hundredth of the step.
double stepped_m(const GroundMotion& motion, double period_s, double ratio) {
  constexpr int kParts = 200;
  const double h = motion.dt_s / kParts;
  const double w = omega(period_s);
  double u = 0.0;
  double v = 0.0;
  double largest = 0.0;
  const auto rate = [&](double at, double of, double ground) { return -ground - 2.0 * ratio * w * of - w * w * at; };
  for (std::size_t i = 0; i + 1 < motion.acceleration_m_per_s2.size(); ++i) {
    const double from = motion.acceleration_m_per_s2[i];
    const double slope = (motion.acceleration_m_per_s2[i + 1] - from) / kParts;
    for (int part = 0; part < kParts; ++part) {
      const double g0 = from + slope * part;
      const double gm = g0 + 0.5 * slope;
      const double a1 = rate(u, v, g0);
      const double a2 = rate(u + 0.5 * h * v, v + 0.5 * h * a1, gm);
      const double a3 = rate(u + 0.5 * h * v + 0.25 * h * h * a1, v + 0.5 * h * a2, gm);
      const double a4 = rate(u + h * v + 0.5 * h * h * a2, v + h * a3, g0 + slope);
      u += h * v + h * h / 6.0 * (a1 + a2 + a3);
      v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
      largest = std::max(largest, std::abs(u));
    }
  }
  return largest;
}

TEST(ResponseSpectrum, ElCentroAgreesWithAnotherMethod) {
  const std::filesystem::path file = shared_data("ground_motions/elcentro_1940_ns.AT2");
  HYBRIDTEST_NEEDS_DATA(file);
  const GroundMotion motion = read_ground_motion(file);
  for (const double period_s : {0.1, 0.5, 1.0, 3.0}) {
    const double expected_m = stepped_m(motion, period_s, 0.05);
    const double found_m = spectrum_ordinate(motion, period_s, 0.05).displacement_m;
    std::cout << "El Centro, 5 %, " << period_s << " s: " << 1e3 * found_m << " mm\n";
    EXPECT_NEAR(found_m, expected_m, kBetweenValues * expected_m) << period_s;
  }
}

}  // namespace
}  // namespace hybridtest
