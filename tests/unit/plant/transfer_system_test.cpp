#include "plant/effects/transfer_system/bandwidth.hpp"

#include <gtest/gtest.h>

#include <complex>

#include "tests/unit/plant/effect_bench.hpp"

namespace hybridtest {
namespace {

double through(const Motion& motion) { return motion.displacement_m; }

TEST(Bandwidth, SineResponseMatchesTransferFunction) {
  constexpr double kOmega = 2.0 * 3.141592653589793 * 4.0;
  constexpr double kTime_s = 0.012;
  for (const double ratio : {0.0, 1e-9, 0.1, 0.2, 0.25, 0.6, 3.0}) {
    Bandwidth effect{std::vector{kTime_s, ratio}, kBenchPeriod_s};
    const auto outputs = response(effect, sine(1.0, kOmega), 4000, through);
    const std::complex<double> s{0.0, kOmega};
    const auto gain = 1.0 / (1.0 + kTime_s * s + ratio * kTime_s * kTime_s * s * s);
    for (std::size_t i = 2000; i < outputs.size(); ++i) {  // 40 time constants of the slowest case later
      const double expected =
          std::abs(gain) * std::sin(kOmega * kBenchPeriod_s * static_cast<double>(i) + std::arg(gain));
      // Straight lines between samples: (omega dt)^2 / 12 of the amplitude.
      ASSERT_NEAR(outputs[i], expected, 6e-5 * std::abs(gain)) << "ratio " << ratio;
    }
  }
}

TEST(Bandwidth, IsContinuousAtFormulaChange) {
  const auto last = [](double time_constant_s, double ratio) {
    Bandwidth effect{std::vector{time_constant_s, ratio}, kBenchPeriod_s};
    return response(effect, sine(1.0, 30.0), 300, through).back();
  };
  EXPECT_NEAR(last(0.02, 0.2), last(0.02, 0.2 + 1e-9), 1e-8);
  EXPECT_NEAR(last(0.999e-6, 0.1), last(1.001e-6, 0.1), 1e-7);
  EXPECT_NEAR(last(0.0, 0.0), std::sin(30.0 * 0.299), 1e-15);
}

TEST(TransferDelay, DelaysByFractionalSamples) {
  const auto effect = made(EffectInterface::transfer_system, "delay", {0.0025});
  const Driver ramp{[](double t) { return t; }, [](double) { return 1.0; }, [](double) { return 0.0; }};
  const auto outputs = response(*effect, ramp, 20, through);
  for (std::size_t i = 4; i < outputs.size(); ++i) {  // with all three samples of the ramp
    EXPECT_NEAR(outputs[i], kBenchPeriod_s * (static_cast<double>(i) - 2.5), 1e-15);
  }
}

TEST(TransferDelay, DelaysSineBetweenSamples) {
  constexpr double kOmega = 60.0;
  const auto effect = made(EffectInterface::transfer_system, "delay", {0.0015});
  const auto outputs = response(*effect, sine(1.0, kOmega), 400, through);
  for (std::size_t i = 5; i < outputs.size(); ++i) {
    // (omega dt)^3 / 16 of the amplitude in the middle between samples; by straight lines it would be (omega dt)^2 / 8.
    EXPECT_NEAR(outputs[i], std::sin(kOmega * (kBenchPeriod_s * static_cast<double>(i) - 0.0015)),
                std::pow(kOmega * kBenchPeriod_s, 3) / 16.0 * 1.01);
  }
}

std::vector<double> moved(const char* name, std::vector<double> values, const std::vector<double>& path) {
  return along(*made(EffectInterface::transfer_system, name, std::move(values)), path, through);
}

TEST(TransferSystemEffects, FollowTheirDefinitionsAlongAPath) {
  const auto expect = [](const std::vector<double>& moved, const std::vector<double>& expected) {
    for (std::size_t i = 0; i < moved.size(); ++i) EXPECT_NEAR(moved[i], expected[i], 1e-12) << i;
  };
  const std::vector<double> path{0.0, 0.05, 0.5, 0.45, 0.2, 0.35};
  expect(moved("backlash", {0.2}, path), {0.0, 0.0, 0.4, 0.4, 0.3, 0.3});
  expect(moved("deadband", {0.1}, path), {0.0, 0.0, 0.4, 0.35, 0.1, 0.25});
  expect(moved("velocity_limit", {100.0}, path), {0.0, 0.05, 0.15, 0.25, 0.2, 0.3});  // 0.1 m in a sample
  expect(moved("stroke_limit", {0.4}, path), {0.0, 0.05, 0.4, 0.4, 0.2, 0.35});
  expect(moved("stiction", {0.1, 0.0}, path), {0.0, 0.0, 0.5, 0.5, 0.2, 0.35});
  expect(moved("gain", {0.1}, path), {0.0, 0.055, 0.55, 0.495, 0.22, 0.385});
}

/// What it is behind a ramp dies away with its slip time, once it is free; it stays where it is when that turns.
TEST(TransferSystemEffects, StictionSlipsInItsTime) {
  constexpr double kSlip_s = 0.004;
  constexpr double kStick = 2.5 * kBenchPeriod_s;
  const auto effect = made(EffectInterface::transfer_system, "stiction", {kStick, kSlip_s});
  double last = 0.0;
  for (int i = 0; i < 40; ++i) {
    const double t = kBenchPeriod_s * i;
    double displacement_m = t;
    effect->after({}, {}, displacement_m);
    // Free between the second and the third sample: t - s e^(-(t - s) / T)
    const double expected = i < 3 ? 0.0 : t - kStick * std::exp(-(t - kStick) / kSlip_s);
    EXPECT_NEAR(displacement_m, expected, 1e-15) << i;
    last = displacement_m;
  }
  double held_m = 38.9 * kBenchPeriod_s;  // back from where it was asked to be
  effect->after({}, {}, held_m);
  EXPECT_NEAR(held_m, last, 1e-15);
}

TEST(TransferSystemEffects, ComplianceYieldsUnderForce) {
  const auto effect = made(EffectInterface::transfer_system, "compliance", {2e-8, 1.0, 0.0});
  double displacement_m = 0.01;
  effect->after({.motion = {}, .time_s = 0.0, .force_n = 1.0e5}, {}, displacement_m);
  EXPECT_DOUBLE_EQ(displacement_m, 0.008);
}

/// Joints that are open give all, joints that have closed r of it and what they took up in closing.
TEST(TransferSystemEffects, ComplianceHasJointsThatClose) {
  constexpr double kCompliance_m_per_n = 2e-8;
  constexpr double kClosing_n = 1.0e4;
  const auto effect = made(EffectInterface::transfer_system, "compliance", {kCompliance_m_per_n, 0.75, kClosing_n});
  const auto given_m = [&](double force_n) {
    double displacement_m = 0.0;
    effect->after({.motion = {}, .time_s = 0.0, .force_n = force_n}, {}, displacement_m);
    return -displacement_m;
  };
  EXPECT_NEAR(given_m(1.0), kCompliance_m_per_n, 1e-8 * kCompliance_m_per_n) << "a third of the square of F / Fc";
  EXPECT_NEAR(given_m(-kClosing_n), -(0.75 + 0.25 * std::tanh(1.0)) * kCompliance_m_per_n * kClosing_n, 1e-18);
  EXPECT_NEAR(given_m(1.0e6), kCompliance_m_per_n * (0.75e6 + 0.25 * kClosing_n), 1e-16);
}

}  // namespace
}  // namespace hybridtest
