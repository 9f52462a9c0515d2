#include <gtest/gtest.h>

#include <set>

#include "tests/unit/plant/effect_bench.hpp"

/// Effects on the way of the targets and in the compensator.
namespace hybridtest {
namespace {

constexpr auto kNetwork = EffectInterface::network;
constexpr auto kCompensator = EffectInterface::compensator;

double through(const Motion& motion) { return motion.displacement_m; }

Driver ramp() {
  return {[](double t) { return t; }, [](double) { return 1.0; }, [](double) { return 0.0; }};
}

TEST(Network, LatencyAndClockOffsetAreDelays) {
  for (const char* name : {"latency", "clock_offset"}) {
    const auto targets = response(*made(kNetwork, name, {0.0125}), ramp(), 100, through);
    for (std::size_t i = 14; i < targets.size(); ++i) {
      ASSERT_NEAR(targets[i], kBenchPeriod_s * static_cast<double>(i) - 0.0125, 1e-13) << name;
    }
  }
}

TEST(Network, ClockDriftGrowsToOneSecond) {
  const auto targets = response(*made(kNetwork, "clock_drift", {0.05}), ramp(), 30000, through);
  for (std::size_t i = 0; i < 19000; ++i) ASSERT_NEAR(targets[i], 0.95 * kBenchPeriod_s * static_cast<double>(i), 1e-9);
  EXPECT_NEAR(targets[29999], 29.999 - 1.0, 1e-9);
}

TEST(Network, LossHoldsNewestAtConfiguredRate) {
  const auto targets = response(*made(kNetwork, "loss", {0.3, 5.0}), ramp(), 20000, through);
  int held = 0;
  for (std::size_t i = 1; i < targets.size(); ++i) {
    ASSERT_GE(targets[i], targets[i - 1]);
    if (targets[i] == targets[i - 1]) ++held;
  }
  EXPECT_NEAR(held / 2e4, 0.3, 4.0 * std::sqrt(0.3 * 0.7 / 2e4));  // four standard deviations
  EXPECT_NE(response(*made(kNetwork, "loss", {0.3, 6.0}), ramp(), 100, through),
            response(*made(kNetwork, "loss", {0.3, 5.0}), ramp(), 100, through));
}

TEST(Network, JitterStaysInBoundAndInOrder) {
  const auto targets = response(*made(kNetwork, "jitter", {0.01, 1.0}), ramp(), 5000, through);
  std::set<int> lateness;
  for (std::size_t i = 20; i < targets.size(); ++i) {
    const double late = kBenchPeriod_s * static_cast<double>(i) - targets[i];
    ASSERT_GE(late, -1e-12);
    ASSERT_LE(late, 0.01 + 1e-12);
    lateness.insert(static_cast<int>(late / kBenchPeriod_s + 0.5));
  }
  EXPECT_GE(lateness.size(), 4U);  // control: it does vary
}

TEST(Compensator, MismatchShiftsTimeAndBiasAdds) {
  const auto shifted = response(*made(kCompensator, "setting_mismatch", {-0.004}), ramp(), 50, through);
  for (std::size_t i = 3; i < shifted.size(); ++i) {
    ASSERT_NEAR(shifted[i], kBenchPeriod_s * static_cast<double>(i) - 0.004, 1e-13);
  }
  EXPECT_DOUBLE_EQ(response(*made(kCompensator, "bias", {0.25}), ramp(), 2, through)[1], 0.251);
}

}  // namespace
}  // namespace hybridtest
