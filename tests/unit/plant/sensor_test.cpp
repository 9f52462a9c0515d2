#include <gtest/gtest.h>

#include "tests/unit/plant/effect_bench.hpp"

/// Effects on transducers against their closed forms.
namespace hybridtest {
namespace {

constexpr auto kForce = EffectInterface::force_sensor;
constexpr auto kDisplacement = EffectInterface::displacement_sensor;

std::vector<double> readings(EffectInterface interface, const char* name, const std::vector<double>& values,
                             const std::vector<double>& outputs) {
  const auto effect = made(interface, name, values);
  std::size_t i = 0;
  return along(*effect, std::vector<double>(outputs.size()), [&](const Motion&) { return outputs[i++]; });
}

TEST(Sensors, ScaleShiftAndDrift) {
  EXPECT_DOUBLE_EQ(readings(kForce, "gain", {0.05}, {4.0})[0], 4.2);
  EXPECT_DOUBLE_EQ(readings(kForce, "bias", {-1.5}, {4.0})[0], 2.5);
  EXPECT_DOUBLE_EQ(readings(kDisplacement, "gain", {-0.5}, {4.0})[0], 2.0);
  EXPECT_DOUBLE_EQ(readings(kDisplacement, "bias", {0.25}, {4.0})[0], 4.25);
  for (const EffectInterface interface : {kForce, kDisplacement}) {
    EXPECT_DOUBLE_EQ(readings(interface, "drift", {2.0}, std::vector<double>(101, 1.0))[100], 1.2);  // after 0.1 s
  }
}

TEST(Sensors, QuantizeAndSaturate) {
  EXPECT_EQ(readings(kForce, "quantization", {0.5}, {0.2, 0.3, -0.8}), (std::vector<double>{0.0, 0.5, -1.0}));
  EXPECT_EQ(readings(kDisplacement, "quantization", {0.5}, {0.2, 0.3, -0.8}), (std::vector<double>{0.0, 0.5, -1.0}));
  EXPECT_EQ(readings(kForce, "saturation", {2.0}, {1.0, 3.0, -2.5}), (std::vector<double>{1.0, 2.0, -2.0}));
}

TEST(Sensors, FollowWithLag) {
  std::vector<double> ramp;
  for (int i = 0; i < 200; ++i) ramp.push_back(i * kBenchPeriod_s);
  constexpr double kTime_s = 0.02;
  for (const EffectInterface interface : {kForce, kDisplacement}) {
    const auto read = readings(interface, "lag", {kTime_s, 0.0}, ramp);
    const auto by_two_poles = readings(interface, "lag", {2.0 * kTime_s, 0.25}, ramp);
    for (std::size_t i = 0; i < ramp.size(); ++i) {
      const double decay = std::exp(-ramp[i] / kTime_s);
      ASSERT_NEAR(read[i], ramp[i] + kTime_s * (decay - 1.0), 1e-13);
      ASSERT_NEAR(by_two_poles[i], ramp[i] - 2.0 * kTime_s + (ramp[i] + 2.0 * kTime_s) * decay, 1e-13);
    }
  }
  const auto skewed = readings(kForce, "time_skew", {0.0035}, ramp);
  for (std::size_t i = 5; i < ramp.size(); ++i) ASSERT_NEAR(skewed[i], ramp[i] - 0.0035, 1e-13);
}

TEST(Sensors, InverseReadingGivesTrueMotion) {
  const Driver driver = sine(0.02, 9.0);
  using Values = std::vector<double>;
  for (const auto& [name, values] : {std::pair{"gain", Values{0.3}},
                                     {"bias", {0.004}},
                                     {"drift", {-0.01}},
                                     {"lag", {0.01, 0.0}},
                                     {"lag", {0.01, 0.25}},
                                     {"lag", {0.01, 0.5}}}) {
    const EffectType* const type = find_effect(kDisplacement, name);
    const auto sensor = type->make(values, kBenchPeriod_s);
    const auto inverse = type->make_inverse(values, kBenchPeriod_s);
    const auto read = response(*sensor, driver, 3000, [](const Motion& motion) { return motion.displacement_m; });
    for (std::size_t i = 1001; i + 1 < read.size(); ++i) {
      const double t = kBenchPeriod_s * static_cast<double>(i);
      const StageSample sample{.motion = {.displacement_m = read[i],
                                          .velocity_m_per_s = (read[i + 1] - read[i - 1]) / (2.0 * kBenchPeriod_s),
                                          .acceleration_m_per_s2 = (read[i + 1] - 2.0 * read[i] + read[i - 1]) /
                                                                   (kBenchPeriod_s * kBenchPeriod_s)},
                               .time_s = t};
      Motion motion = sample.motion;
      inverse->before(sample, motion);
      // Central differences and straight lines: (omega dt)^2 / 6 of the amplitude at most.
      ASSERT_NEAR(motion.displacement_m, driver.displacement_m(t), 0.02 * 1.4e-5) << name;
    }
  }
}

/// The lag of an acceleration is taken off by its own differences: the rate is of second order in the sample period,
/// the change of the rate of the first.
TEST(Sensors, LaggedAccelerationIsInverted) {
  constexpr double kTime_s = 0.004;
  constexpr double kOmega = 2.0 * std::numbers::pi * 3.0;
  constexpr double kAngle = kOmega * kBenchPeriod_s;
  for (const double ratio : {0.0, 0.25}) {
    const auto inverse = find_effect(kDisplacement, "lag")->make_inverse(std::vector{kTime_s, ratio}, kBenchPeriod_s);
    const double second_order = ratio * std::pow(kTime_s * kOmega, 2);
    for (int round = 0; round < 2; ++round) {  // and as new after a reset
      for (int i = 0; i < 500; ++i) {
        const double t = kBenchPeriod_s * i;
        Motion motion{.displacement_m = 0.0, .velocity_m_per_s = 0.0, .acceleration_m_per_s2 = std::cos(kOmega * t)};
        inverse->before({.motion = motion, .time_s = t}, motion);
        if (i < 2) continue;
        const double expected = (1.0 - second_order) * std::cos(kOmega * t) - kTime_s * kOmega * std::sin(kOmega * t);
        ASSERT_NEAR(motion.acceleration_m_per_s2, expected,
                    1.01 * (kTime_s * kOmega * std::pow(kAngle, 2) / 3.0 + second_order * kAngle));
      }
      inverse->reset();
    }
  }
}

}  // namespace
}  // namespace hybridtest
