#include <gtest/gtest.h>

#include "tests/unit/effects/effect_bench.hpp"

/// Effects that are a formula of the motion at the sample.
namespace hybridtest {
namespace {

TEST(LinearSpecimen, AddsTheForceOfItsElement) {
  const Driver driver = sine(0.01, 12.0);
  struct Case {
    const char* name;
    double value;
    std::function<double(double)> expected;
  };
  for (const Case& c : {Case{"stiffness_error", -3.0e5, [&](double t) { return -3.0e5 * driver.displacement_m(t); }},
                        Case{"viscous_damping", 2.0e4, [&](double t) { return 2.0e4 * driver.velocity_m_per_s(t); }},
                        Case{"inertia", 95.0, [&](double t) { return 95.0 * driver.acceleration_m_per_s2(t); }}}) {
    const auto effect = made(EffectInterface::specimen, c.name, {c.value});
    const auto forces = response(*effect, driver, 500, [](const Motion&) { return 7.0; });
    for (std::size_t i = 0; i < forces.size(); ++i) {
      ASSERT_NEAR(forces[i], 7.0 + c.expected(kBenchPeriod_s * static_cast<double>(i)), 1e-9) << c.name;
    }
  }
}

TEST(LinearSpecimen, SensorsScaleAndShift) {
  const auto unit = [](const Motion&) { return 4.0; };
  EXPECT_DOUBLE_EQ(response(*made(EffectInterface::force_sensor, "gain", {0.05}), sine(1, 1), 2, unit)[1], 4.2);
  EXPECT_DOUBLE_EQ(response(*made(EffectInterface::force_sensor, "bias", {-1.5}), sine(1, 1), 2, unit)[1], 2.5);
  EXPECT_DOUBLE_EQ(response(*made(EffectInterface::displacement_sensor, "gain", {-0.5}), sine(1, 1), 2, unit)[1], 2.0);
  EXPECT_DOUBLE_EQ(response(*made(EffectInterface::displacement_sensor, "bias", {0.25}), sine(1, 1), 2, unit)[1], 4.25);
  EXPECT_DOUBLE_EQ(response(*made(EffectInterface::transfer_system, "gain", {0.1}), sine(1, 1), 2, unit)[1], 4.4);
}

}  // namespace
}  // namespace hybridtest
