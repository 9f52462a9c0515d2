#include "scenario/loop_sections.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/unit/scenario/scenario_file.hpp"

namespace hybridtest {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

class LoopSectionsTest : public testing::Test {
 protected:
  /// The sound scenario in paced mode, with other limits and keys beside them.
  static std::string scenario_with(const std::string& limits_and_more) {
    return with("    limits: {displacement_m: 0.2, velocity_m_per_s: 1.5, force_n: 150.0e3}\n", limits_and_more,
                with("mode: lockstep", "mode: paced"));
  }
  LoopScenario read(const std::string& limits_and_more) const {
    return file_.read(scenario_with(limits_and_more)).substructures[0].site.loop;
  }
  std::vector<std::string> errors(const std::string& limits_and_more) const {
    return file_.errors(scenario_with(limits_and_more));
  }
  static const InterlockRule& rule(const LoopScenario& loop, InterlockKind kind) {
    return loop.rules[static_cast<std::size_t>(kind)];
  }

  static constexpr const char* kLimits = "    limits: {displacement_m: 0.2, velocity_m_per_s: 1.5, force_n: 150.0e3}\n";
  ScenarioFile file_;
};

TEST_F(LoopSectionsTest, LimitsAloneAreTheShortForm) {
  const LoopScenario loop = read(kLimits);
  EXPECT_EQ(loop.limits.displacement_m, 0.2);
  EXPECT_EQ(loop.limits.command_age_s, 1.0);
  EXPECT_FALSE(loop.limits.energy_error_ratio || loop.limits.force_step_n || loop.limits.displacement_step_m ||
               loop.limits.tracking_indicator);
  const InterlockRules defaults = default_interlock_rules();
  for (std::size_t i = 0; i < kInterlockCount; ++i) {
    EXPECT_EQ(loop.rules[i].action, defaults[i].action) << i;
    EXPECT_EQ(loop.rules[i].clears, ClearCondition::never) << i;
  }
  EXPECT_EQ(loop.trajectory.type, TrajectoryType::predictor_corrector);
  EXPECT_EQ(loop.trajectory.order, 2);
  EXPECT_EQ(loop.ramp_in_s, 0.0);
  EXPECT_FALSE(loop.captures_zero_offsets);
  EXPECT_TRUE(loop.returns_at_end);
  EXPECT_EQ(loop.return_time_s, 2.0);
}

TEST_F(LoopSectionsTest, FullInterlocksHaveLimitActionAndClearCondition) {
  const std::string text = R"(    interlocks:
      displacement: {limit_m: 0.21, action: release}
      velocity: {limit_m_per_s: 1.6}
      force: {limit_n: 151.0e3, action: hold, clears: operator_reset}
      tracking_error: {limit_m: 0.02, action: warn, clears: when_cleared}
      energy_error: {limit_ratio: 0.3}
      displacement_step: {limit_m: 0.001}
      force_step: {limit_n: 2.0e3, action: release}
      stuck_sensor: {limit_samples: 100, while_moving_m: 2.0e-4}
      tracking_indicator: {limit_lag_sine: 0.4, window_s: 2.0, action: warn}
      command_age: {limit_s: 0.5, clears: when_cleared}
      not_finite: {action: release}
      rig_status: {action: release}
    trajectory: {type: ramp_and_hold, hold_share: 0.3}
    ramp_in_s: 4.0
    zero_offsets: capture
    at_end: hold
)";
  const LoopScenario loop = read(text);
  EXPECT_EQ(loop.limits.displacement_m, 0.21);
  EXPECT_EQ(loop.limits.velocity_m_per_s, 1.6);
  EXPECT_EQ(loop.limits.force_n, 151.0e3);
  EXPECT_EQ(loop.limits.tracking_error_m, 0.02);
  EXPECT_EQ(loop.limits.energy_error_ratio, 0.3);
  EXPECT_EQ(loop.limits.displacement_step_m, 0.001);
  EXPECT_EQ(loop.limits.force_step_n, 2.0e3);
  EXPECT_EQ(loop.limits.stuck_samples, 100);
  EXPECT_EQ(loop.limits.stuck_while_moving_m, 2.0e-4);
  EXPECT_EQ(loop.limits.tracking_indicator, 0.4);
  EXPECT_EQ(loop.tracking_window_s, 2.0);
  EXPECT_EQ(loop.limits.command_age_s, 0.5);
  EXPECT_EQ(rule(loop, InterlockKind::displacement).action, SafetyAction::release);
  EXPECT_EQ(rule(loop, InterlockKind::velocity).action, SafetyAction::ramp_to_zero);
  EXPECT_EQ(rule(loop, InterlockKind::force).action, SafetyAction::hold);
  EXPECT_EQ(rule(loop, InterlockKind::force).clears, ClearCondition::operator_reset);
  EXPECT_EQ(rule(loop, InterlockKind::tracking_error).action, SafetyAction::warn);
  EXPECT_EQ(rule(loop, InterlockKind::command_age).clears, ClearCondition::when_cleared);
  EXPECT_EQ(rule(loop, InterlockKind::not_finite).action, SafetyAction::release);
  EXPECT_EQ(loop.trajectory.type, TrajectoryType::ramp_and_hold);
  EXPECT_EQ(loop.trajectory.hold_share, 0.3);
  EXPECT_EQ(loop.ramp_in_s, 4.0);
  EXPECT_TRUE(loop.captures_zero_offsets);
  EXPECT_FALSE(loop.returns_at_end);

  const Scenario scenario = file_.read(scenario_with(text));
  EXPECT_EQ(file_.read(scenario.effective).digest, scenario.digest) << "the effective scenario says the same";
}

TEST_F(LoopSectionsTest, DeadSensorsAreNoticedByDefault) {
  const SiteLimits limits = read(kLimits).limits;
  // An actuator of 0.9/(15 pi) + 0.004 s behind a compensator of 0.023 s; control periods of 0.5 ms.
  const double delay_s = 0.9 / (15.0 * M_PI) + 0.004;
  ASSERT_TRUE(limits.tracking_error_m);
  EXPECT_NEAR(*limits.tracking_error_m, 0.1 * 0.2 + 1.5 * (delay_s - 0.023), 1e-12);
  EXPECT_EQ(limits.stuck_samples, static_cast<int>(std::ceil((0.1 + delay_s) / 0.0005)));
  EXPECT_DOUBLE_EQ(limits.stuck_while_moving_m, 0.001 * 0.2);
  EXPECT_TRUE(limits.stuck_judges_force);

  const std::string effective = file_.read(scenario_with(kLimits)).effective;
  EXPECT_THAT(effective, HasSubstr("limit_samples: 247"));
  EXPECT_THAT(effective, HasSubstr("sensors: displacement_and_force"));
  EXPECT_THAT(effective, HasSubstr("tracking_error:\n        limit_m: 0.02014"));
}

TEST_F(LoopSectionsTest, DefaultInterlocksAreOffOnlyByName) {
  const auto has_tracking_and_stuck = [](const SiteLimits& limits) {
    return std::pair{limits.tracking_error_m.has_value(), limits.stuck_samples.has_value()};
  };
  const auto interlocks = [](const std::string& text) {
    return std::string{kLimits} + "    interlocks: {" + text + "}\n";
  };
  using Both = std::pair<bool, bool>;
  EXPECT_EQ(has_tracking_and_stuck(read(kLimits).limits), Both(true, true));
  EXPECT_EQ(has_tracking_and_stuck(read(interlocks("stuck_sensor: off")).limits), Both(true, false));
  EXPECT_EQ(has_tracking_and_stuck(read(interlocks("tracking_error: off")).limits), Both(false, true));
  const std::string short_form =
      "    limits: {displacement_m: 0.2, velocity_m_per_s: 1.5, force_n: 150.0e3, tracking_error_m: off}\n";
  EXPECT_EQ(has_tracking_and_stuck(read(short_form).limits), Both(false, true));
  for (const std::string& text : {interlocks("stuck_sensor: off, tracking_error: off"), short_form}) {
    const Scenario scenario = file_.read(scenario_with(text));
    EXPECT_EQ(file_.read(scenario.effective).digest, scenario.digest) << "off stays off";
  }
  EXPECT_THAT(errors(short_form + "    interlocks: {tracking_error: {action: warn}}\n"),
              testing::ElementsAre(HasSubstr("off by limits.tracking_error_m already")));
  EXPECT_THAT(errors(interlocks("force: off")), testing::Not(testing::IsEmpty())) << "only these two";
  const LoopScenario warns = read(interlocks("tracking_error: {action: warn}, stuck_sensor: {action: warn}"));
  EXPECT_EQ(has_tracking_and_stuck(warns.limits), Both(true, true)) << "a rule alone keeps the default limit";
  EXPECT_EQ(rule(warns, InterlockKind::stuck_sensor).action, SafetyAction::warn);
}

TEST_F(LoopSectionsTest, StuckSensorDefaultsKnowTheRigsReadings) {
  const auto limits = [&](const std::vector<std::string>& overrides) {
    return file_.read(kScenarioText, overrides).substructures[0].site.loop.limits;
  };
  const std::string rig = "substructures[storey_1].rig";
  EXPECT_FALSE(limits({rig + ".sensors.force_noise_n=0.0"}).stuck_judges_force) << "constant on a plateau";
  const SiteLimits coarse = limits({rig + ".effects=[{interface: displacement_sensor, effect: quantization, step_m: "
                                          "0.001}, {interface: force_sensor, effect: quantization, step_n: 100.0}]"});
  EXPECT_DOUBLE_EQ(coarse.stuck_while_moving_m, 0.002);
  EXPECT_FALSE(coarse.stuck_judges_force);
  const SiteLimits late = limits({rig + "={type: udp, host: a, port: 1, pace: datagrams, watchdog_s: 2.0}"});
  EXPECT_EQ(late.stuck_samples, 4200) << "a silent link is the watchdog's";
  EXPECT_TRUE(late.stuck_judges_force);
  EXPECT_DOUBLE_EQ(*late.tracking_error_m, 0.1 * 0.2 + 1.5 * 0.023) << "what the compensator is set to is the rig's";
  std::ofstream{file_.directory() / "recorded.csv"}
      << "time_s,measured_displacement_m,measured_force_n\n0.0,0.0,0.0\n1.0,0.0,0.0\n";
  const SiteLimits replayed = limits({rig + "={type: replay, recording: recorded.csv, at_end: hold}"});
  EXPECT_FALSE(replayed.stuck_samples || replayed.tracking_error_m) << "a recording follows no commands";
}

TEST_F(LoopSectionsTest, InterlockRuleAppliesToShortFormLimit) {
  const LoopScenario loop = read(std::string{kLimits} + "    interlocks: {force: {action: release}}\n");
  EXPECT_EQ(loop.limits.force_n, 150.0e3);
  EXPECT_EQ(rule(loop, InterlockKind::force).action, SafetyAction::release);
}

TEST_F(LoopSectionsTest, RejectsInconsistentSettings) {
  const auto one_error = [&](const std::string& interlocks, const char* what) {
    const auto found = errors(std::string{kLimits} + "    interlocks: {" + interlocks + "}\n");
    ASSERT_THAT(found, SizeIs(1)) << interlocks;
    EXPECT_THAT(found[0], HasSubstr(what));
  };
  one_error("force: {limit_n: 1.0}", "limits.force_n already");
  one_error("command_age: {limit_s: 0.5, action: stop}", "ramp_to_zero");
  one_error("forse: {action: hold}", "force");
  one_error("energy_error: {action: hold}", "limit_ratio");
  one_error("not_finite: {action: warn}", "NaN or infinity cannot be commanded");
  one_error("force: {clears: when_cleared}", "expected never");
  one_error("tracking_indicator: {limit_lag_sine: 1.5}", "limit_lag_sine");
  EXPECT_THAT(errors("    limits: {displacement_m: 0.2, velocity_m_per_s: 1.5}\n"), SizeIs(1)) << "no force limit";
  const auto lockstep =
      file_.errors(with("    limits:", "    interlocks: {command_age: {clears: when_cleared}}\n    limits:"));
  ASSERT_THAT(lockstep, SizeIs(1));
  EXPECT_THAT(lockstep[0], HasSubstr("in lockstep"));
}

}  // namespace
}  // namespace hybridtest
