#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/unit/plant/effect_bench.hpp"

namespace hybridtest {
namespace {

TEST(CoulombFriction, DissipatesFourTimesForceTimesAmplitudePerCycle) {
  constexpr double kForce_n = 512.0;
  constexpr double kPresliding_m = 1e-5;
  constexpr double kAmplitude_m = 0.01;
  const auto effect = made(EffectInterface::specimen, "coulomb_friction", {kForce_n, 0.0, kPresliding_m, 0.0});
  const Driver driver = sine(kAmplitude_m, 2.0 * 3.141592653589793);
  const auto forces = response(*effect, driver, 3001);
  // An elastoplastic loop: 4 Fc (A - d); the trapezium misses the corners by about 2 Fc d.
  EXPECT_NEAR(work_j(forces, driver, 1000, 2000), 4.0 * kForce_n * (kAmplitude_m - kPresliding_m),
              2.0 * kForce_n * kPresliding_m);
}

TEST(CoulombFriction, SticksAtRestAndSlidesAsymmetrically) {
  const auto effect = made(EffectInterface::specimen, "coulomb_friction", {100.0, 0.2, 1e-3, 0.0});
  const auto forces = along(*effect, {0.0, 0.5e-3, 0.5e-3, 5e-3, 4.5e-3, 4e-3, 0.0});
  EXPECT_NEAR(forces[1], 60.0, 1e-9);   // half of the way to 100 (1 + 0.2)
  EXPECT_NEAR(forces[2], 60.0, 1e-9);   // at rest it holds
  EXPECT_NEAR(forces[3], 120.0, 1e-9);  // slides
  EXPECT_NEAR(forces[4], 60.0, 1e-9);
  EXPECT_NEAR(forces[5], 0.0, 1e-9);
  EXPECT_NEAR(forces[6], -80.0, 1e-9);
}

/// From rest, and after a reversal: with w = 1 - z sign(dx) and u the way over d, w^(1 - i) falls by (1 - i) u, and by
/// an exponential for i = 1 (Dahl, 1968). In one step or in many.
TEST(CoulombFriction, CreepsBeforeItSlidesAsDahlsEquationSays) {
  constexpr double kPresliding_m = 1e-3;
  const auto left_after = [](double left, double way_m, double exponent) {
    const double u = way_m / kPresliding_m;
    if (exponent == 1.0) return left * std::exp(-u);
    const double power = std::pow(left, 1.0 - exponent) - (1.0 - exponent) * u;
    return power > 0.0 ? std::pow(power, 1.0 / (1.0 - exponent)) : 0.0;
  };
  for (const double exponent : {0.0, 0.5, 1.0, 2.0}) {
    SCOPED_TRACE(exponent);
    const double out_m = 1.5e-3;
    const double back_m = 0.7e-3;
    const auto effect = made(EffectInterface::specimen, "coulomb_friction", {100.0, 0.0, kPresliding_m, exponent});
    const double there = 1.0 - left_after(1.0, out_m, exponent);
    const double returned = left_after(1.0 + there, out_m - back_m, exponent) - 1.0;
    const auto in_one_step = along(*effect, {0.0, out_m, back_m});
    EXPECT_NEAR(in_one_step[1], 100.0 * there, 1e-9);
    EXPECT_NEAR(in_one_step[2], 100.0 * returned, 1e-9);
    effect->reset();
    std::vector<double> path_m;
    for (int i = 0; i <= 100; ++i) path_m.push_back(out_m * i / 100.0);
    for (int i = 1; i <= 100; ++i) path_m.push_back(out_m + (back_m - out_m) * i / 100.0);
    EXPECT_NEAR(along(*effect, path_m).back(), 100.0 * returned, 1e-9);
  }
}

/// After each reversal it comes near sliding again: the work of a cycle is 4 Fc (A - d), less what is left at the ends.
TEST(CoulombFriction, ThatCreepsDissipatesTheSameEnergyPerCycle) {
  constexpr double kForce_n = 512.0;
  constexpr double kPresliding_m = 1e-4;
  constexpr double kAmplitude_m = 0.01;
  const auto effect = made(EffectInterface::specimen, "coulomb_friction", {kForce_n, 0.0, kPresliding_m, 1.0});
  const Driver driver = sine(kAmplitude_m, 2.0 * 3.141592653589793);
  const auto forces = response(*effect, driver, 3001);
  // Each half cycle loses the integral of 2 exp(-u / d), 2 d. The trapezium misses curvature: (du / d)^2 / 12 of it,
  // where a step du near a reversal is 0.2 to 0.6 of d.
  EXPECT_NEAR(work_j(forces, driver, 1000, 2000), 4.0 * kForce_n * (kAmplitude_m - kPresliding_m),
              0.1 * 4.0 * kForce_n * kPresliding_m);
}

}  // namespace
}  // namespace hybridtest
