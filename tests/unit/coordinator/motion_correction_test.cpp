#include "coordinator/excitation/motion_correction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

/// A pulse train with an offset and a drift, as a poor record has them.
GroundMotion drifting() {
  GroundMotion motion{.dt_s = 0.01, .start_s = 0.0, .acceleration_m_per_s2 = {}};
  for (int i = 0; i <= 2000; ++i) {
    const double t = 0.01 * i;
    motion.acceleration_m_per_s2.push_back(std::sin(3.0 * t) * std::exp(-0.1 * t) + 0.02 + 0.003 * t);
  }
  return motion;
}

/// Mean square of the velocity of the ground.
double mean_square_velocity(const GroundMotion& motion) {
  double velocity = 0.0;
  double sum = 0.0;
  for (std::size_t i = 1; i < motion.acceleration_m_per_s2.size(); ++i) {
    velocity += 0.5 * motion.dt_s * (motion.acceleration_m_per_s2[i - 1] + motion.acceleration_m_per_s2[i]);
    sum += velocity * velocity;
  }
  return sum / static_cast<double>(motion.acceleration_m_per_s2.size());
}

TEST(MotionEnd, ConstantAccelerationFollowsClosedForm) {
  const GroundMotion motion{.dt_s = 0.1, .start_s = 0.0, .acceleration_m_per_s2 = std::vector<double>(11, 2.0)};
  EXPECT_NEAR(motion_end(motion).velocity_m_per_s, 2.0, 1e-14);
  EXPECT_NEAR(motion_end(motion).displacement_m, 1.0, 1e-14);
}

TEST(Baseline, LeavesTheGroundAtRest) {
  EXPECT_GT(std::abs(motion_end(drifting()).velocity_m_per_s), 0.5);
  for (const auto correction : {BaselineCorrection::mean, BaselineCorrection::linear, BaselineCorrection::quadratic}) {
    GroundMotion motion = drifting();
    correct_baseline(motion, correction);
    EXPECT_NEAR(motion_end(motion).velocity_m_per_s, 0.0, 1e-12);
  }
}

TEST(Baseline, HigherDegreesLeaveLessVelocity) {
  double before = mean_square_velocity(drifting());
  for (const auto correction : {BaselineCorrection::mean, BaselineCorrection::linear, BaselineCorrection::quadratic}) {
    GroundMotion motion = drifting();
    correct_baseline(motion, correction);
    EXPECT_LT(mean_square_velocity(motion), before);
    before = mean_square_velocity(motion);
  }
}

TEST(Baseline, RemovesItsOwnPolynomialWholly) {
  GroundMotion parabola{.dt_s = 0.02, .start_s = 0.0, .acceleration_m_per_s2 = {}};
  for (int i = 0; i <= 500; ++i) parabola.acceleration_m_per_s2.push_back(0.3 - 0.1 * i + 2e-4 * i * i);
  GroundMotion motion = parabola;
  correct_baseline(motion, BaselineCorrection::quadratic);
  EXPECT_LT(motion.peak_m_per_s2(), 1e-11);
  motion = parabola;
  correct_baseline(motion, BaselineCorrection::linear);
  EXPECT_GT(motion.peak_m_per_s2(), 1.0) << "control: a line does not";
}

TEST(Baseline, NoneChangesNothing) {
  GroundMotion motion = drifting();
  correct_baseline(motion, BaselineCorrection::none);
  EXPECT_EQ(motion.acceleration_m_per_s2, drifting().acceleration_m_per_s2);
}

/// Amplitude and delay of a sine in the middle of a filtered one, by projection on sine and cosine.
struct Passed {
  double in_phase = 0.0;
  double out_of_phase = 0.0;
};
Passed passed(double frequency_hz, const HighPassFilter& high_pass) {
  constexpr int kPerCycle = 200;
  constexpr int kCycles = 120;
  const double dt_s = 1.0 / frequency_hz / kPerCycle;
  GroundMotion motion{.dt_s = dt_s, .start_s = 0.0, .acceleration_m_per_s2 = {}};
  const auto phase = [](int i) { return 2.0 * std::numbers::pi * i / kPerCycle; };
  for (int i = 0; i < kPerCycle * kCycles; ++i) motion.acceleration_m_per_s2.push_back(std::sin(phase(i)));
  filter(motion, high_pass);
  Passed found;
  constexpr int kFrom = kPerCycle * kCycles / 2;
  for (int i = kFrom; i < kFrom + kPerCycle; ++i) {
    const double value = motion.acceleration_m_per_s2[static_cast<std::size_t>(i)];
    found.in_phase += 2.0 / kPerCycle * value * std::sin(phase(i));
    found.out_of_phase += 2.0 / kPerCycle * value * std::cos(phase(i));
  }
  return found;
}

TEST(HighPass, PassesTheShareOfButterworthTwiceWithoutDelay) {
  for (const int order : {1, 2, 3, 4, 8}) {
    for (const double over : {0.5, 1.0, 1.5, 4.0}) {
      const HighPassFilter high_pass{.frequency_hz = 0.2, .order = order};
      const Passed found = passed(over * high_pass.frequency_hz, high_pass);
      const double expected = 1.0 / (1.0 + std::pow(over, -2.0 * order));
      EXPECT_NEAR(found.in_phase, expected, 1e-3) << order << " at " << over;
      EXPECT_NEAR(found.out_of_phase, 0.0, 1e-3) << order << " at " << over;
    }
  }
}

TEST(HighPass, WithABaselineAfterItLeavesTheGroundWhereItWas) {
  GroundMotion motion = drifting();
  const double before_m = std::abs(motion_end(motion).displacement_m);
  filter(motion, {.frequency_hz = 0.1, .order = 4});
  EXPECT_EQ(motion.acceleration_m_per_s2.size(), drifting().acceleration_m_per_s2.size()) << "keeps its times";
  correct_baseline(motion, BaselineCorrection::quadratic);
  EXPECT_NEAR(motion_end(motion).velocity_m_per_s, 0.0, 1e-12);
  EXPECT_LT(std::abs(motion_end(motion).displacement_m), 0.05 * before_m);
}

TEST(HighPass, RefusesFrequenciesThatTheRecordCannotShow) {
  GroundMotion motion = drifting();
  EXPECT_THROW(filter(motion, {.frequency_hz = 30.0, .order = 4}), ConfigError);
  EXPECT_THROW(filter(motion, {.frequency_hz = 1e-5, .order = 4}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
