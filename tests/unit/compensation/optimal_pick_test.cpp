#include "compensation/optimal_pick.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1e-3;
constexpr double kOmega = 12.0;

// A specimen with a force of its own for each direction: the same displacement alone does not tell it.
double displacement_m(double t) { return 0.01 * std::sin(kOmega * t); }
double force_n(double t) { return 1e6 * 0.01 * std::sin(kOmega * t + 0.5); }

TEST(OptimalPick, ReturnsForceOfTheTimeTargetWasReached) {
  constexpr double kLead_s = 4.3e-3;  // the specimen is early by that
  OptimalPick pick{{0.012}, kPeriod_s};
  for (int i = 0; i < 2000; ++i) {
    const double t = kPeriod_s * i;
    const double picked_n =
        pick.corrected_force({displacement_m(t), displacement_m(t + kLead_s), force_n(t + kLead_s)});
    if (i < 20) continue;
    // Where the displacement is fast, the straight lines err by (w T)^2 / 8 = 2e-5 of the amplitude, twice. In
    // the peaks, by half the time between samples: w T / 2 = 6e-3. Where target and specimen are on either
    // side of the peak, by the lead: what differs between two instants of one displacement.
    const double slope = std::abs(std::cos(kOmega * t));
    ASSERT_NEAR(picked_n, force_n(t), 1e4 * (slope > 0.2 ? 4e-5 / slope : 1.2 * kOmega * kLead_s)) << i;
  }
}

TEST(OptimalPick, ReturnsNearestForceIfTargetWasNotReached) {
  OptimalPick pick{{0.010}, kPeriod_s};
  for (int i = 0; i <= 10; ++i) static_cast<void>(pick.corrected_force({0.0, 1e-3 * i, 100.0 * i}));
  EXPECT_EQ(pick.corrected_force({0.5, 0.009, 900.0}), 1000.0);  // the sample at 10 mm
}

TEST(OptimalPick, SearchesOnlyItsWindow) {
  OptimalPick pick{{0.005}, kPeriod_s};
  for (int i = 0; i <= 10; ++i) static_cast<void>(pick.corrected_force({1.0, 1e-3 * i, 100.0 * i}));
  EXPECT_EQ(pick.corrected_force({0.0, 0.011, 1100.0}), 600.0);
}

TEST(OptimalPick, IsTheIdentityWithoutTrackingError) {
  OptimalPick pick{{0.010}, kPeriod_s};
  for (int i = 0; i < 100; ++i) {
    const double t = kPeriod_s * i;
    ASSERT_DOUBLE_EQ(pick.corrected_force({displacement_m(t), displacement_m(t), force_n(t)}), force_n(t)) << i;
  }
}

TEST(OptimalPick, RejectsAWindowOutOfRange) {
  EXPECT_THROW((OptimalPick{{0.0}, kPeriod_s}), ConfigError);
  EXPECT_THROW((OptimalPick{{1.5}, kPeriod_s}), ConfigError);
  EXPECT_THROW((OptimalPick{{1e-4}, kPeriod_s}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
