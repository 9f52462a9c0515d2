#include <gtest/gtest.h>

#include "tests/unit/plant/effect_bench.hpp"

namespace hybridtest {
namespace {

TEST(CoulombFriction, DissipatesFourTimesForceTimesAmplitudePerCycle) {
  constexpr double kForce_n = 512.0;
  constexpr double kPresliding_m = 1e-5;
  constexpr double kAmplitude_m = 0.01;
  const auto effect = made(EffectInterface::specimen, "coulomb_friction", {kForce_n, 0.0, kPresliding_m});
  const Driver driver = sine(kAmplitude_m, 2.0 * 3.141592653589793);
  const auto forces = response(*effect, driver, 3001);
  double work_j = 0.0;
  for (std::size_t i = 1001; i < 2001; ++i) {
    const auto at = [&](std::size_t k) { return driver.displacement_m(kBenchPeriod_s * static_cast<double>(k)); };
    work_j += 0.5 * (forces[i] + forces[i - 1]) * (at(i) - at(i - 1));
  }
  // An elastoplastic loop: 4 Fc (A - d); the trapezium misses the corners by about 2 Fc d.
  EXPECT_NEAR(work_j, 4.0 * kForce_n * (kAmplitude_m - kPresliding_m), 2.0 * kForce_n * kPresliding_m);
}

TEST(CoulombFriction, SticksAtRestAndSlidesAsymmetrically) {
  const auto effect = made(EffectInterface::specimen, "coulomb_friction", {100.0, 0.2, 1e-3});
  const auto forces = along(*effect, {0.0, 0.5e-3, 0.5e-3, 5e-3, 4.5e-3, 4e-3, 0.0});
  EXPECT_NEAR(forces[1], 60.0, 1e-9);   // half of the way to 100 (1 + 0.2)
  EXPECT_NEAR(forces[2], 60.0, 1e-9);   // at rest it holds
  EXPECT_NEAR(forces[3], 120.0, 1e-9);  // slides
  EXPECT_NEAR(forces[4], 60.0, 1e-9);
  EXPECT_NEAR(forces[5], 0.0, 1e-9);
  EXPECT_NEAR(forces[6], -80.0, 1e-9);
}

}  // namespace
}  // namespace hybridtest
