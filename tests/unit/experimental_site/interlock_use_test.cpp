#include "experimental_site/interlock_use.hpp"

#include <gtest/gtest.h>

#include <span>
#include <vector>

#include "experimental_site/control_record.hpp"
#include "tests/support/kept_rows.hpp"

namespace hybridtest {
namespace {

const SiteLimits kLimits{.displacement_m = 0.1,
                         .velocity_m_per_s = 1.0,
                         .force_n = 1e5,
                         .tracking_error_m = 0.005,
                         .energy_error_ratio = 0.5,
                         .command_age_s = 2.0,
                         .displacement_step_m = 0.002,
                         .force_step_n = 500.0,
                         .stuck_samples = 20,
                         .tracking_indicator = 0.3};

/// Recorded control samples of a site with two interface degrees of freedom.
class InterlockUseTest : public testing::Test {
 protected:
  void sample(double factor, bool follows = true) {
    const auto both = [&](double first, double second) {
      SiteVector values{2};
      values << factor * first, factor * second;
      return values;
    };
    const SiteVector target = both(0.010, -0.050);
    const SiteVector measured = both(0.011, -0.048);
    const SiteVector force = both(2.0e3, -9.0e3);
    const SiteVector velocity = both(-0.4, 0.2);
    record_.append({.target_displacement_m = target,
                    .command_displacement_m = target,
                    .measured_displacement_m = measured,
                    .measured_force_n = force,
                    .compensated_force_n = force,
                    .tracking_lag_sine = -0.12,
                    .target_velocity_m_per_s = velocity,
                    .energy_error_ratio = 0.25,
                    .command_age_s = 0.5,
                    .follows_targets = follows});
    const std::size_t width = rows_.layout().columns.size();
    use_.read(std::span{rows_.values()}.last(width));
  }
  [[nodiscard]] double observed(InterlockKind kind) const {
    const auto level = use_.level(kind);
    EXPECT_TRUE(level.has_value()) << name(kind);
    return level ? level->observed : -1.0;
  }

  KeptRows rows_{ControlRecord::layout(2)};
  ControlRecord record_{2, rows_};
  InterlockUse use_{kLimits, rows_.layout()};
};

TEST_F(InterlockUseTest, ReadsWhatTheInterlocksCompare) {
  sample(1.0);
  sample(1.02);
  EXPECT_DOUBLE_EQ(observed(InterlockKind::displacement), 1.02 * 0.050);
  EXPECT_DOUBLE_EQ(observed(InterlockKind::velocity), 1.02 * 0.4);
  EXPECT_DOUBLE_EQ(observed(InterlockKind::force), 1.02 * 9.0e3);
  EXPECT_NEAR(observed(InterlockKind::tracking_error), 1.02 * 0.002, 1e-15);
  EXPECT_DOUBLE_EQ(observed(InterlockKind::energy_error), 0.25);
  EXPECT_DOUBLE_EQ(observed(InterlockKind::tracking_indicator), 0.12);
  EXPECT_DOUBLE_EQ(observed(InterlockKind::command_age), 0.5);
  EXPECT_NEAR(observed(InterlockKind::displacement_step), 0.02 * 0.048, 1e-15);
  EXPECT_NEAR(observed(InterlockKind::force_step), 0.02 * 9.0e3, 1e-9);
  EXPECT_EQ(use_.level(InterlockKind::force)->limit, 1e5);
}

TEST_F(InterlockUseTest, TrackingIsNotJudgedWhereNoTargetIsFollowed) {
  sample(1.0, false);
  EXPECT_FALSE(use_.level(InterlockKind::tracking_error).has_value());
  EXPECT_FALSE(use_.level(InterlockKind::velocity).has_value());
  EXPECT_DOUBLE_EQ(observed(InterlockKind::displacement), 0.048) << "measured, not the target that is not followed";
}

TEST_F(InterlockUseTest, CountersAndSwitchesHaveNoLevel) {
  sample(1.0);
  for (const InterlockKind kind : {InterlockKind::stuck_sensor, InterlockKind::not_finite, InterlockKind::rig_status}) {
    EXPECT_FALSE(use_.level(kind).has_value()) << name(kind);
  }
}

TEST_F(InterlockUseTest, OlderRecordingsLackSomeLevels) {
  TableLayout old = ControlRecord::layout(1);
  old.columns.resize(old.columns.size() - 4);
  InterlockUse use{kLimits, old};
  std::vector<double> row(old.columns.size(), 0.0);
  row[3] = 0.04;  // target
  use.read(row);
  EXPECT_FALSE(use.level(InterlockKind::velocity).has_value());
  EXPECT_FALSE(use.level(InterlockKind::command_age).has_value());
  EXPECT_FALSE(use.level(InterlockKind::energy_error).has_value());
  EXPECT_TRUE(use.level(InterlockKind::force).has_value());
}

}  // namespace
}  // namespace hybridtest
