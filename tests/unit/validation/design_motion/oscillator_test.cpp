#include "validation/design_motion/oscillator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace hybridtest::design_motion {
namespace {

constexpr double kPeriod_s = 0.8;
constexpr double kRatio = 0.05;
constexpr double kOmega = 2.0 * std::numbers::pi / kPeriod_s;

TEST(Oscillator, IsExactForStepAcceleration) {
  // u = -(A/w^2) (1 - e^{-zwt} (cos w't + z w/w' sin w't)), whatever the step.
  constexpr double kAcceleration = 3.0;
  const double damped = kOmega * std::sqrt(1.0 - kRatio * kRatio);
  for (const double dt_s : {0.001, 0.05, 0.7}) {
    Oscillator oscillator{kPeriod_s, kRatio, dt_s};
    for (int step = 1; step <= 50; ++step) {
      oscillator.advance(kAcceleration, kAcceleration);
      const double time_s = step * dt_s;
      const double decay = std::exp(-kRatio * kOmega * time_s);
      const double expected =
          -kAcceleration / (kOmega * kOmega) *
          (1.0 - decay * (std::cos(damped * time_s) + kRatio * kOmega / damped * std::sin(damped * time_s)));
      ASSERT_NEAR(oscillator.displacement_m(), expected, 1e-14);
      const double velocity =
          -kAcceleration / (kOmega * kOmega) * decay * kOmega * kOmega / damped * std::sin(damped * time_s);
      ASSERT_NEAR(oscillator.velocity_m_per_s(), velocity, 1e-13);
    }
  }
}

TEST(Oscillator, IsExactForRamp) {
  // Undamped, a = s t: u = -(s/w^2) (t - sin(wt)/w).
  constexpr double kSlope = 2.0;
  constexpr double kStep_s = 0.03;
  Oscillator oscillator{kPeriod_s, 0.0, kStep_s};
  for (int step = 1; step <= 100; ++step) {
    oscillator.advance(kSlope * (step - 1) * kStep_s, kSlope * step * kStep_s);
    const double time_s = step * kStep_s;
    const double expected = -kSlope / (kOmega * kOmega) * (time_s - std::sin(kOmega * time_s) / kOmega);
    ASSERT_NEAR(oscillator.displacement_m(), expected, 1e-13);
  }
}

TEST(PeakResponse, UndampedStepResponseIsTwiceStatic) {
  for (const double dt_s : {0.01, 0.4, 2.0}) {  // far apart samples are subdivided
    const auto peak =
        peak_response(std::vector<double>(static_cast<std::size_t>(2.0 / dt_s) + 2, 1.5), dt_s, kPeriod_s, 0.0);
    EXPECT_LE(std::abs(peak.pseudo_acceleration_m_per_s2), 3.0 + 1e-12);
    EXPECT_GE(std::abs(peak.pseudo_acceleration_m_per_s2), 3.0 * (1.0 - 0.0016));  // (1 + cos(pi/40))/2
    EXPECT_LT(peak.pseudo_acceleration_m_per_s2, 0.0);                             // it lags behind the ground
  }
}

TEST(PeakResponse, DampedStepOvershootMatchesClosedForm) {
  // Peak at half the damped period, 1 + exp(-pi z/sqrt(1 - z^2)).
  const auto peak = peak_response(std::vector<double>(2000, 1.0), 0.001, kPeriod_s, kRatio);
  const double root = std::sqrt(1.0 - kRatio * kRatio);
  EXPECT_NEAR(-peak.pseudo_acceleration_m_per_s2, 1.0 + std::exp(-std::numbers::pi * kRatio / root), 1e-5);
  EXPECT_NEAR(peak.time_s, 0.5 * kPeriod_s / root, 0.001);
}

TEST(PeakResponse, ResonanceGivesInverseOfTwiceDamping) {
  constexpr double kStep_s = 0.001;
  std::vector<double> sine;
  for (int i = 0; i < 40000; ++i) sine.push_back(std::sin(kOmega * i * kStep_s));
  // 50 periods: exp(-50 * 2 pi 0.05) = 1e-7 left of the start; straight lines cost (w dt)^2/12.
  EXPECT_NEAR(std::abs(peak_response(sine, kStep_s, kPeriod_s, kRatio).pseudo_acceleration_m_per_s2), 10.0, 1e-3);
}

TEST(PeakResponse, StiffOscillatorHasGroundPeak) {
  std::vector<double> pulse;
  for (int i = 0; i <= 200; ++i) pulse.push_back(-4.0 * std::sin(std::numbers::pi * i / 200.0));
  const auto peak = peak_response(pulse, 0.01, 0.005, kRatio);
  EXPECT_NEAR(peak.pseudo_acceleration_m_per_s2, 4.0, 0.01);
  EXPECT_NEAR(peak.time_s, 1.0, 0.02);
}

}  // namespace
}  // namespace hybridtest::design_motion
