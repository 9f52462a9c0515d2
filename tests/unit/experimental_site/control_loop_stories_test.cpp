#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/random.hpp"
#include "tests/unit/experimental_site/control_loop_bench.hpp"

/// What a site lives through between arming and rest, one story each.
namespace hybridtest {
namespace {

using Bench = LoopBench;
constexpr double kStiffness_n_per_m = Bench::kStiffness_n_per_m;
constexpr double kPeriod_s = Bench::kPeriod_s;

InterlockRule& rule(ControlLoopSettings& settings, InterlockKind kind) {
  return settings.rules[static_cast<std::size_t>(kind)];
}

/// Answers every measurement with the next target of a slow sine until `periods` have passed.
class SineTest {
 public:
  explicit SineTest(Bench& bench) : bench_{bench} {}

  void run(int periods) {
    for (int i = 0; i < periods; ++i) {
      bench_.advance();
      for (const LoopReport& report : bench_.take_reports()) {
        reports.push_back(report);
        if (const auto* measured = std::get_if<StepMeasurement>(&report)) give_target(measured->step + 1);
      }
    }
  }
  void give_target(Step step) {
    constexpr double kOmega = 4.0;
    const double angle = kOmega * Bench::kStep_s * static_cast<double>(step);
    bench_.target(step, 0.02 * (1.0 - std::cos(angle)), 0.02 * kOmega * std::sin(angle),
                  0.02 * kOmega * kOmega * std::cos(angle));
  }
  template <class Report>
  [[nodiscard]] int count() const {
    return static_cast<int>(std::ranges::count_if(
        reports, [](const LoopReport& report) { return std::holds_alternative<Report>(report); }));
  }

  std::vector<LoopReport> reports;

 private:
  Bench& bench_;
};

void start(Bench& bench, SineTest& test) {
  bench.ask(loop_request::Arm{});
  bench.ask(loop_request::Start{});
  test.give_target(0);
}

/// Largest change of velocity between two control periods [m/s].
double largest_velocity_change(const Bench& bench, std::size_t from, std::size_t to) {
  double largest = 0.0;
  for (std::size_t i = std::max<std::size_t>(from, 2); i < to; ++i) {
    const auto at = [&](std::size_t k) { return bench.rig.commands[k].displacement_m[0]; };
    largest = std::max(largest, std::abs(at(i) - 2.0 * at(i - 1) + at(i - 2)) / kPeriod_s);
  }
  return largest;
}

TEST(ControlLoopStories, WarningIsReportedAndTestContinues) {
  ControlLoopSettings settings = Bench::settings(CouplingMode::paced);
  rule(settings, InterlockKind::force) = {SafetyAction::warn, ClearCondition::when_cleared};
  settings.limits.force_n = 3000.0;  // passed at 0.03 m, on each of the sine's crests
  Bench bench{settings, ideal_spring_rig(kStiffness_n_per_m)};
  SineTest test{bench};
  start(bench, test);
  test.run(5000);
  EXPECT_EQ(test.count<loop_report::Fault>(), 0);
  EXPECT_EQ(test.count<loop_report::Warning>(), 3);
  EXPECT_EQ(test.count<loop_report::Cleared>(), 3);
  EXPECT_GE(test.count<StepMeasurement>(), 1240);
}

/// Ten holds in a test, each of which clears. @param velocity_change_m_per_s   bound after each.
void expect_ten_holds_passed(bool compensates, double velocity_change_m_per_s) {
  ControlLoopSettings settings = Bench::settings(CouplingMode::paced);
  rule(settings, InterlockKind::rig_status) = {SafetyAction::hold, ClearCondition::when_cleared};
  bool has_fault = false;
  const auto spring = ideal_spring_rig(kStiffness_n_per_m);
  Bench bench{settings,
              [&](const ActuatorCommand& command, RigFeedback& feedback) {
                static_cast<void>(spring(command, feedback));
                return has_fault ? RigStatus::fault : RigStatus::healthy;
              },
              compensates};
  SineTest test{bench};
  start(bench, test);
  for (int hold = 0; hold < 10; ++hold) {
    test.run(197);  // in a different part of a step each time
    has_fault = true;
    test.run(1);
    const double held_m = bench.command_m();
    test.run(300);
    EXPECT_EQ(bench.command_m(), held_m);
    EXPECT_EQ(test.count<loop_report::Warning>(), hold + 1);
    has_fault = false;
    test.run(99);
    EXPECT_EQ(bench.command_m(), held_m) << "cleared for less than a tenth of a second";
    const std::size_t resumed = bench.rig.commands.size();
    test.run(100);
    EXPECT_NE(bench.command_m(), held_m);
    EXPECT_LT(largest_velocity_change(bench, resumed, bench.rig.commands.size()), velocity_change_m_per_s);
  }
  EXPECT_EQ(test.count<loop_report::Fault>(), 0);
  Step step = 0;
  for (const LoopReport& report : test.reports) {
    if (const auto* measured = std::get_if<StepMeasurement>(&report)) {
      EXPECT_EQ(measured->step, step++);
    }
  }
  EXPECT_GT(step, 600);
}

TEST(ControlLoopStories, ClearedHoldContinuesFromRestWithoutJump) {
  // The path picks up kRateRecovery of its rate in a step: at 0.08 m/s and four periods to a step
  // 0.04 m/s in a period.
  expect_ten_holds_passed(false, 0.041);
}

TEST(ControlLoopStories, ClearedHoldWithPredictiveCompensatorHasNoJump) {
  // A cubic predictor that looks as far ahead as its points are apart has weights 4, -6, 4, -1.
  expect_ten_holds_passed(true, 15.0 * 0.041);
}

TEST(ControlLoopStories, OperatorHoldContinuesOnResume) {
  ControlLoopSettings settings = Bench::settings(CouplingMode::paced);
  rule(settings, InterlockKind::command_age) = {SafetyAction::hold, ClearCondition::operator_reset};
  Bench bench{settings, ideal_spring_rig(kStiffness_n_per_m)};
  bench.start();
  bench.target(1, 0.0004, 0.1);
  for (int i = 0; i < 300; ++i) bench.advance();
  const double held_m = bench.command_m();
  bench.take_reports();
  bench.target(2, 0.0008, 0.1);
  for (int i = 0; i < 300; ++i) bench.advance();
  EXPECT_EQ(bench.command_m(), held_m);
  EXPECT_TRUE(bench.take_reports().empty());
  bench.ask(loop_request::Resume{});
  for (int i = 0; i < 30; ++i) bench.advance();
  const auto reports = bench.take_reports();
  ASSERT_EQ(reports.size(), 2U);
  EXPECT_TRUE(std::holds_alternative<loop_report::Cleared>(reports[0]));
  EXPECT_EQ(std::get<StepMeasurement>(reports[1]).step, 2);
}

TEST(ControlLoopStories, ReleaseStopsRigInThePeriodOfTheTrip) {
  ControlLoopSettings settings = Bench::settings(CouplingMode::paced);
  rule(settings, InterlockKind::force).action = SafetyAction::release;
  settings.limits.force_n = 1000.0;
  Bench bench{settings, ideal_spring_rig(kStiffness_n_per_m)};
  SineTest test{bench};
  start(bench, test);
  test.run(3000);
  EXPECT_EQ(test.count<loop_report::Fault>(), 1);
  EXPECT_GE(bench.rig.stops, 1);
  const std::size_t count = bench.rig.commands.size();
  EXPECT_GT(kStiffness_n_per_m * bench.command_m(), 1000.0);
  EXPECT_LE(kStiffness_n_per_m * bench.rig.commands[count - 2].displacement_m[0], 1000.0) << "the one before";
}

TEST(ControlLoopStories, HoldingSiteReturnsOnMoreSevereAction) {
  double extra_n = 0.0;
  const auto spring = ideal_spring_rig(kStiffness_n_per_m);
  Bench bench{Bench::settings(CouplingMode::paced), [&](const ActuatorCommand& command, RigFeedback& feedback) {
                static_cast<void>(spring(command, feedback));
                feedback.force_n[0] += extra_n;
                return RigStatus::healthy;
              }};
  bench.start();
  bench.target(1, 0.0004, 0.1);
  for (int i = 0; i < 200; ++i) bench.advance();
  EXPECT_EQ(bench.take_fault()->fault, FaultFlags::command_age);
  EXPECT_NE(bench.command_m(), 0.0);
  extra_n = 2.0e4;
  for (int i = 0; i < 300; ++i) bench.advance();
  EXPECT_EQ(bench.take_fault()->fault, FaultFlags::force_limit);
  EXPECT_EQ(bench.command_m(), 0.0);
  EXPECT_GE(bench.rig.stops, 1);
}

TEST(ControlLoopStories, SubtractsZeroOffsetsCapturedAtArming) {
  ControlLoopSettings settings = Bench::settings(CouplingMode::paced);
  settings.captures_zero_offsets = true;
  settings.limits.displacement_step_m = 0.001;
  settings.limits.force_step_n = 100.0;
  constexpr double kOffset_m = 0.0123;
  constexpr double kOffset_n = -456.0;
  Random random{2};
  const auto spring = ideal_spring_rig(kStiffness_n_per_m);
  Bench bench{settings, [&](const ActuatorCommand& command, RigFeedback& feedback) {
                static_cast<void>(spring(command, feedback));
                feedback.displacement_m[0] += kOffset_m + random.uniform(-1e-5, 1e-5);
                feedback.force_n[0] += kOffset_n + random.uniform(-1.0, 1.0);
                return RigStatus::healthy;
              }};
  bench.ask(loop_request::Arm{});
  for (int i = 0; i < 99; ++i) bench.advance();
  EXPECT_TRUE(bench.take_reports().empty()) << "not armed before a tenth of a second of samples is in";
  bench.advance();
  const auto reports = bench.take_reports();
  ASSERT_EQ(reports.size(), 2U);
  const auto& offset = std::get<loop_report::ZeroOffset>(reports[0]);
  // A mean of 100 uniform values: five times its standard deviation, width / sqrt(12 * 100).
  EXPECT_NEAR(offset.displacement_m, kOffset_m, 5.0 * 2e-5 / std::sqrt(1200.0));
  EXPECT_NEAR(offset.force_n, kOffset_n, 5.0 * 2.0 / std::sqrt(1200.0));
  EXPECT_TRUE(std::holds_alternative<loop_report::Armed>(reports[1]));
  for (int i = 0; i < 50; ++i) bench.advance();
  bench.ask(loop_request::Start{});
  bench.target(0, 0.0);
  bench.advance();
  const auto measured = bench.take_reports();
  ASSERT_EQ(measured.size(), 1U) << "and no step interlock for the offset that was taken off";
  EXPECT_NEAR(std::get<StepMeasurement>(measured[0]).measured_displacement_m[0], 0.0, 2e-5);
  EXPECT_NEAR(std::get<StepMeasurement>(measured[0]).force_n[0], 0.0, 2.0);
}

TEST(ControlLoopStories, FaultDoesNotSubtractZeroOffsetsTwice) {
  ControlLoopSettings settings = Bench::settings(CouplingMode::paced);
  settings.captures_zero_offsets = true;
  bool is_silent = false;
  Bench bench{settings, [&](const ActuatorCommand&, RigFeedback& feedback) {
                if (is_silent) return RigStatus::fault;  // the feedback stays the last good one
                feedback.displacement_m[0] = 0.0123;
                feedback.force_n[0] = -456.0;
                return RigStatus::healthy;
              }};
  bench.ask(loop_request::Arm{});
  for (int i = 0; i < 100; ++i) bench.advance();
  bench.ask(loop_request::Start{});
  bench.target(0, 0.0);
  bench.advance();
  is_silent = true;
  for (int i = 0; i < 50; ++i) bench.advance();
  // What the mean of 100 equal numbers is off them by rounding.
  EXPECT_NEAR(bench.record.column_values("measured_displacement_m").back(), 0.0, 1e-15);
  EXPECT_NEAR(bench.record.column_values("measured_force_n").back(), 0.0, 1e-10);
}

TEST(ControlLoopStories, OffsetsBeyondLimitsAreAFaultAndNotApplied) {
  ControlLoopSettings settings = Bench::settings(CouplingMode::lockstep);
  settings.captures_zero_offsets = true;
  Bench bench{settings, [](const ActuatorCommand&, RigFeedback& feedback) {
                feedback.displacement_m[0] = 0.0;
                feedback.force_n[0] = 2.0e4;
                return RigStatus::healthy;
              }};
  bench.ask(loop_request::Arm{});
  bench.advance();
  const auto reports = bench.take_reports();
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_EQ(std::get<loop_report::Fault>(reports[0]).fault, FaultFlags::force_limit);
}

TEST(ControlLoopStories, BlendsIntoFirstTargetsAndThenReachesThem) {
  for (const double ramp_in_s : {0.0, 0.5}) {
    ControlLoopSettings settings = Bench::settings(CouplingMode::paced);
    settings.ramp_in_s = ramp_in_s;
    settings.limits.velocity_m_per_s = 10.0;  // a single step lets it no other way
    Bench bench{settings, ideal_spring_rig(kStiffness_n_per_m)};
    bench.ask(loop_request::Arm{});
    bench.ask(loop_request::Start{});
    constexpr double kStart_m = 0.01;
    constexpr double kVelocity_m_per_s = 0.02;
    const auto give = [&](Step step) {
      bench.target(step, kStart_m + kVelocity_m_per_s * Bench::kStep_s * static_cast<double>(step), kVelocity_m_per_s);
    };
    give(0);
    Step next = 1;
    double worst_late_m = 0.0;
    for (int i = 0; i < 1000; ++i) {
      bench.advance();
      for (const LoopReport& report : bench.take_reports()) {
        ASSERT_FALSE(std::holds_alternative<loop_report::Fault>(report));
        const auto* measured = std::get_if<StepMeasurement>(&report);
        if (measured == nullptr) continue;
        give(next++);
        if (i * kPeriod_s <= std::max(ramp_in_s, Bench::kStep_s) + Bench::kStep_s) continue;
        worst_late_m =
            std::max(worst_late_m, std::abs(measured->measured_displacement_m[0] - measured->target_displacement_m[0]));
      }
    }
    EXPECT_LT(worst_late_m, 1e-15) << "a path that is straight is met to rounding";
    const double duration_s = std::max(ramp_in_s, Bench::kStep_s);
    // The cubic's largest second derivative: 6 d / T^2 + 4 v / T.
    const double bound =
        (6.0 * kStart_m / (duration_s * duration_s) + 4.0 * kVelocity_m_per_s / duration_s) * kPeriod_s;
    EXPECT_LE(largest_velocity_change(bench, 0, bench.rig.commands.size()), bound);
    EXPECT_EQ(bench.rig.commands.front().displacement_m[0], 0.0);
  }
}

TEST(ControlLoopStories, StopsAtTheEndAndHoldsOrReturnsAsConfigured) {
  for (const bool returns : {true, false}) {
    ControlLoopSettings settings = Bench::settings(CouplingMode::paced);
    settings.returns_at_end = returns;
    Bench bench{settings, ideal_spring_rig(kStiffness_n_per_m)};
    SineTest test{bench};
    start(bench, test);
    test.run(397);  // at 0.08 m/s
    const double stopped_m = bench.command_m();
    bench.ask(loop_request::Stop{});
    const std::size_t from = bench.rig.commands.size();
    while (test.count<loop_report::AtRest>() == 0) test.run(1);
    // Down from 0.08 m/s in 20 ms, and the return's own acceleration: 0.004 + 0.003 at most.
    EXPECT_LT(largest_velocity_change(bench, from, bench.rig.commands.size()), 0.007);
    if (returns) {
      EXPECT_EQ(bench.command_m(), 0.0);
    } else {
      EXPECT_NEAR(bench.command_m(), stopped_m + 0.5 * 0.08 * 0.02, 1e-4);
    }
    EXPECT_EQ(bench.rig.stops, 1);
  }
}

}  // namespace
}  // namespace hybridtest
