#include "experimental_site/control_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "core/random.hpp"
#include "tests/unit/experimental_site/control_loop_bench.hpp"

namespace hybridtest {
namespace {

using Bench = LoopBench;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kStiffness_n_per_m = Bench::kStiffness_n_per_m;
constexpr Duration kPeriod = Bench::kPeriod;
constexpr double kPeriod_s = Bench::kPeriod_s;
constexpr int kPeriodsPerStep = Bench::kPeriodsPerStep;
constexpr double kStep_s = Bench::kStep_s;

TEST(ControlLoop, HoldsZeroBetweenArmingAndStart) {
  Bench bench{Bench::settings(CouplingMode::paced), ideal_spring_rig(kStiffness_n_per_m)};
  EXPECT_EQ(bench.advance(), kNever);
  EXPECT_TRUE(bench.rig.commands.empty());
  bench.ask(loop_request::Arm{});
  for (int i = 0; i < 10; ++i) bench.advance();
  const auto reports = bench.take_reports();
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<loop_report::Armed>(reports.front()));
  EXPECT_TRUE(bench.rig.is_armed);
  ASSERT_EQ(bench.rig.commands.size(), 10U);
  for (const ActuatorCommand& command : bench.rig.commands) EXPECT_EQ(command.displacement_m[0], 0.0);
}

TEST(ControlLoop, ReportsRigThatCannotArmWithoutMotion) {
  Bench bench{Bench::settings(CouplingMode::paced), ideal_spring_rig(kStiffness_n_per_m)};
  bench.rig.on_arm = [] { throw std::runtime_error{"no pressure"}; };
  bench.ask(loop_request::Arm{});
  bench.ask(loop_request::Start{});
  bench.target(0, 0.01);
  for (int i = 0; i < 10; ++i) bench.advance();
  const auto reports = bench.take_reports();
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<loop_report::ArmFailed>(reports.front()));
  EXPECT_TRUE(bench.rig.commands.empty());
}

TEST(ControlLoop, MeasuresExactlyAtTargetWithIdealRig) {
  Bench bench{Bench::settings(CouplingMode::lockstep), ideal_spring_rig(kStiffness_n_per_m)};
  bench.start();
  Random random{5};
  double displacement_m = 0.0;
  for (Step step = 1; step <= 200; ++step) {
    displacement_m += random.uniform(-1e-4, 1e-4);
    bench.target(step, displacement_m, random.uniform(-0.02, 0.02), random.uniform(-1.0, 1.0));
    bench.advance();
    const auto reports = bench.take_reports();
    ASSERT_EQ(reports.size(), 1U);
    const StepMeasurement& measured = std::get<StepMeasurement>(reports.front());
    EXPECT_EQ(measured.step, step);
    EXPECT_EQ(measured.model_time_s, static_cast<double>(step) * kStep_s);
    // The last control period falls on the target: the cubic there is the target, summed of four
    // rounded products.
    EXPECT_NEAR(measured.measured_displacement_m[0], displacement_m, 4 * kEpsilon * 1e-2);
    EXPECT_EQ(measured.force_n[0], kStiffness_n_per_m * measured.measured_displacement_m[0]);
    EXPECT_EQ(measured.flags, MeasurementFlags::none);
  }
  EXPECT_EQ(bench.rig.commands.size(), 1 + 200U * kPeriodsPerStep);
}

TEST(ControlLoop, InterpolatesMeasurementAtLateTarget) {
  Bench bench{Bench::settings(CouplingMode::paced), ideal_spring_rig(kStiffness_n_per_m)};
  bench.start();
  constexpr double kVelocity_m_per_s = 0.1;
  bench.target(1, kVelocity_m_per_s * kStep_s, kVelocity_m_per_s);
  while (bench.take_reports().empty()) bench.advance();
  for (int i = 0; i < 15; ++i) bench.advance();  // late
  EXPECT_TRUE(bench.take_reports().empty());
  bench.target(2, 2 * kVelocity_m_per_s * kStep_s, kVelocity_m_per_s);
  std::vector<LoopReport> reports;
  for (int i = 0; i < 20 && reports.empty(); ++i) {
    bench.advance();
    reports = bench.take_reports();
  }
  ASSERT_EQ(reports.size(), 1U);
  const StepMeasurement& measured = std::get<StepMeasurement>(reports.front());
  constexpr auto kLate = MeasurementFlags::late | MeasurementFlags::extrapolated | MeasurementFlags::held;
  EXPECT_EQ(measured.flags, kLate);
  // Straight interpolation misses a path of curvature k by at most k h^2/8. The path from where
  // it waited, next to the target, with its full slope at both ends bends by no more than
  // 6 times the change of slope over the rest of the step.
  const double bend_m_per_s2 = 6.0 * kVelocity_m_per_s / (0.4 * kStep_s);
  EXPECT_NEAR(measured.measured_displacement_m[0], 2 * kVelocity_m_per_s * kStep_s,
              bend_m_per_s2 * kPeriod_s * kPeriod_s / 8.0);
  EXPECT_LT(bench.rig.commands.size(), 45U);
}

struct LimitCase {
  const char* name;
  FaultFlags fault;
  bool holds;  // instead of the return to zero
  /// What the rig does from its fifteenth exchange on.
  void (*spoil)(RigFeedback& feedback, RigStatus& status);
};

class EveryLimit : public testing::TestWithParam<LimitCase> {};

TEST_P(EveryLimit, TripsInTheControlPeriodThatExceedsIt) {
  ControlLoopSettings settings = Bench::settings(CouplingMode::paced);
  settings.limits.tracking_error_m = 0.02;
  settings.limits.energy_error_ratio = 0.5;
  const LimitCase& limit = GetParam();
  int exchanges = 0;
  const auto spring = ideal_spring_rig(kStiffness_n_per_m);
  Bench bench{settings, [&](const ActuatorCommand& command, RigFeedback& feedback) {
                RigStatus status = spring(command, feedback);
                if (++exchanges >= 15) limit.spoil(feedback, status);
                return status;
              }};
  bench.start();
  Step step = 1;
  const auto next_target = [&] {
    const double displacement_m = 0.001 * static_cast<double>(step);
    bench.target(step++, displacement_m, 0.25);
  };
  next_target();
  while (exchanges < 14) {
    bench.advance();
    for (const LoopReport& report : bench.take_reports()) {
      ASSERT_TRUE(std::holds_alternative<StepMeasurement>(report));
      next_target();
    }
  }
  bench.advance();
  ASSERT_EQ(exchanges, 15);
  const auto fault = bench.take_fault();
  ASSERT_TRUE(fault.has_value());
  EXPECT_EQ(fault->fault, limit.fault);

  const double tripped_m = bench.command_m();
  EXPECT_NE(tripped_m, 0.0);
  for (int i = 0; i < 300; ++i) bench.advance();
  EXPECT_TRUE(bench.take_reports().empty()) << "rest is reported only to who asked for it";
  if (limit.holds) {
    EXPECT_EQ(bench.command_m(), tripped_m);
    EXPECT_EQ(bench.rig.stops, 0);
    EXPECT_EQ(exchanges, 315);
  } else {
    EXPECT_EQ(bench.command_m(), 0.0);
    EXPECT_GE(bench.rig.stops, 1);
    EXPECT_EQ(exchanges, 15 + 200);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Limits, EveryLimit,
    testing::Values(LimitCase{"displacement", FaultFlags::displacement_limit, false,
                              [](RigFeedback& feedback, RigStatus&) { feedback.displacement_m[0] = -0.1001; }},
                    LimitCase{"force", FaultFlags::force_limit, false,
                              [](RigFeedback& feedback, RigStatus&) { feedback.force_n[0] = -1.0001e4; }},
                    LimitCase{"tracking_error", FaultFlags::tracking_error, false,
                              [](RigFeedback& feedback, RigStatus&) { feedback.displacement_m[0] -= 0.0201; }},
                    LimitCase{"energy_error", FaultFlags::energy_error, false,
                              [](RigFeedback& feedback, RigStatus&) {
                                feedback.displacement_m[0] -= 0.015;
                                feedback.force_n[0] = 9.9e3;
                              }},
                    LimitCase{"force_not_finite", FaultFlags::not_finite, true,
                              [](RigFeedback& feedback, RigStatus&) { feedback.force_n[0] = kNan; }},
                    LimitCase{"displacement_not_finite", FaultFlags::not_finite, true,
                              [](RigFeedback& feedback, RigStatus&) {
                                feedback.displacement_m[0] = std::numeric_limits<double>::infinity();
                              }},
                    LimitCase{"rig_fault", FaultFlags::rig_fault, true,
                              [](RigFeedback&, RigStatus& status) { status = RigStatus::fault; }}),
    [](const auto& limit) { return limit.param.name; });

TEST(ControlLoop, TargetBeyondLimitTripsAndCommandStaysInside) {
  Bench too_far{Bench::settings(CouplingMode::paced), ideal_spring_rig(kStiffness_n_per_m)};
  too_far.start();
  too_far.target(1, 0.2);
  std::optional<loop_report::Fault> fault;
  for (int i = 0; i < kPeriodsPerStep && !fault; ++i) {
    too_far.advance();
    fault = too_far.take_fault();
  }
  ASSERT_TRUE(fault.has_value());
  EXPECT_EQ(fault->fault, FaultFlags::velocity_limit) << "0.2 m in 4 ms are passed on the way there";
  EXPECT_GT(fault->observed, 0.5);
  EXPECT_EQ(fault->limit, 0.5);
  for (const ActuatorCommand& command : too_far.rig.commands) {
    EXPECT_LE(std::abs(command.displacement_m[0]), 0.5 * kPeriod_s * static_cast<double>(command.sample + 1));
  }

  Bench not_a_number{Bench::settings(CouplingMode::paced), ideal_spring_rig(kStiffness_n_per_m)};
  not_a_number.start();
  not_a_number.target(1, kNan);
  not_a_number.advance();
  fault = not_a_number.take_fault();
  ASSERT_TRUE(fault.has_value());
  EXPECT_EQ(fault->fault, FaultFlags::not_finite);
  EXPECT_EQ(fault->observed, static_cast<double>(SiteSignal::target));
  EXPECT_EQ(fault->limit, 1.0) << "the interface degree of freedom";
  EXPECT_EQ(not_a_number.command_m(), 0.0);
}

TEST(ControlLoop, HoldsAfterNonFiniteValuesAlsoWhenStopped) {
  bool is_broken = false;
  const auto spring = ideal_spring_rig(kStiffness_n_per_m);
  Bench bench{Bench::settings(CouplingMode::paced), [&](const ActuatorCommand& command, RigFeedback& feedback) {
                static_cast<void>(spring(command, feedback));
                if (is_broken) feedback.force_n[0] = kNan;
                return RigStatus::healthy;
              }};
  bench.start();
  bench.target(1, 0.001, 0.2);
  for (int i = 0; i < 4; ++i) bench.advance();
  static_cast<void>(bench.take_reports());
  is_broken = true;
  bench.advance();
  const auto fault = bench.take_fault();
  ASSERT_TRUE(fault.has_value());
  EXPECT_EQ(fault->observed, static_cast<double>(SiteSignal::measured_force));
  const double held_m = bench.command_m();
  EXPECT_GT(held_m, 0.0);
  bench.take_reports();
  bench.ask(loop_request::Stop{});
  bench.advance();
  const auto reports = bench.take_reports();
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<loop_report::AtRest>(reports.front()));
  EXPECT_EQ(bench.rig.stops, 1);
  for (int i = 0; i < 10; ++i) bench.advance();
  EXPECT_EQ(bench.command_m(), held_m);
}

TEST(ControlLoop, ReturnsToZeroAtMostAtHalfVelocityLimit) {
  ControlLoopSettings settings = Bench::settings(CouplingMode::lockstep);
  settings.return_time_s = 0.0;  // as fast as the limit lets it
  Bench bench{settings, ideal_spring_rig(kStiffness_n_per_m)};
  bench.start();
  constexpr Step kSteps = 80;
  constexpr double kOmega = std::numbers::pi / (kSteps * kStep_s);
  for (Step step = 1; step <= kSteps; ++step) {
    const double phase = kOmega * kStep_s * static_cast<double>(step);
    bench.target(step, 0.04 * (1.0 - std::cos(phase)), 0.04 * kOmega * std::sin(phase));
    bench.advance();
  }
  bench.take_reports();
  const double begin_m = bench.command_m();
  ASSERT_NEAR(begin_m, 0.08, 1e-12);
  const std::size_t before = bench.rig.commands.size();
  bench.ask(loop_request::Stop{});
  while (bench.take_reports().empty()) bench.advance();
  // The last sample before still moved: it comes to a stand first, over 20 ms, half of that
  // velocity further on.
  constexpr std::size_t kHalt = 20;
  const double velocity_m_per_s = (begin_m - bench.rig.commands[before - 2].displacement_m[0]) / kPeriod_s;
  const double stand_m = bench.rig.commands[before + kHalt - 1].displacement_m[0];
  EXPECT_NEAR(stand_m, begin_m + 0.5 * velocity_m_per_s * kHalt * kPeriod_s, 1e-12);
  double last_m = stand_m;
  double fastest_m_per_s = 0.0;
  for (std::size_t i = before + kHalt; i < bench.rig.commands.size(); ++i) {
    const double command_m = bench.rig.commands[i].displacement_m[0];
    EXPECT_LE(command_m, last_m);
    fastest_m_per_s = std::max(fastest_m_per_s, (last_m - command_m) / kPeriod_s);
    last_m = command_m;
  }
  EXPECT_EQ(last_m, 0.0);
  EXPECT_LE(fastest_m_per_s, 0.25);
  // As long as it takes at that speed, T = pi a / v, to the period above.
  EXPECT_EQ(bench.rig.commands.size() - before,
            kHalt + static_cast<std::size_t>(std::ceil(std::numbers::pi * stand_m / 0.5 / kPeriod_s)));
}

TEST(ControlLoop, ReturnFromZeroSendsZeros) {
  ControlLoopSettings settings = Bench::settings(CouplingMode::lockstep);
  settings.return_time_s = 0.0;
  Bench bench{settings, ideal_spring_rig(kStiffness_n_per_m)};
  bench.start();
  bench.ask(loop_request::Stop{});
  bench.advance();
  const auto reports = bench.take_reports();
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<loop_report::AtRest>(reports.front()));
  for (const ActuatorCommand& command : bench.rig.commands) EXPECT_EQ(command.displacement_m[0], 0.0);
}

TEST(ControlLoop, EmergencyStopEndsMotionAtOnce) {
  Bench bench{Bench::settings(CouplingMode::paced), ideal_spring_rig(kStiffness_n_per_m)};
  bench.start();
  bench.target(1, 0.001, 0.2);
  bench.advance();
  const std::size_t exchanges = bench.rig.commands.size();
  bench.ask(loop_request::EmergencyStop{});
  EXPECT_EQ(bench.advance(), kNever);
  EXPECT_GE(bench.rig.stops, 1);
  for (int i = 0; i < 10; ++i) bench.advance();
  EXPECT_EQ(bench.rig.commands.size(), exchanges);
  const auto reports = bench.take_reports();
  ASSERT_EQ(reports.size(), 2U);
  EXPECT_EQ(std::get<loop_report::Fault>(reports.front()).fault, FaultFlags::emergency_stop);
  EXPECT_TRUE(std::holds_alternative<loop_report::AtRest>(reports.back()));
}

TEST(ControlLoop, HoldsWhenNextTargetIsOverdue) {
  Bench bench{Bench::settings(CouplingMode::paced), ideal_spring_rig(kStiffness_n_per_m)};
  bench.start();
  bench.target(1, 0.0004, 0.1);
  const Instant given = bench.now;
  std::optional<loop_report::Fault> fault;
  while (!fault) {
    bench.advance();
    ASSERT_LT(bench.now, given + std::chrono::seconds{1});
    fault = bench.take_fault();
  }
  EXPECT_EQ(fault->fault, FaultFlags::command_age);
  EXPECT_EQ(bench.now - kPeriod, given + std::chrono::milliseconds{101}) << "the first period older than 100 ms";
  const double held_m = bench.command_m();
  bench.target(2, 0.0008, 0.1);
  for (int i = 0; i < 20; ++i) bench.advance();
  EXPECT_EQ(bench.command_m(), held_m) << "a target that comes after all moves nothing";
}

TEST(ControlLoop, LockstepWakesForOverdueTarget) {
  Bench bench{Bench::settings(CouplingMode::lockstep), ideal_spring_rig(kStiffness_n_per_m)};
  bench.start();
  const Instant overdue = bench.loop.advance(bench.now);
  EXPECT_EQ(overdue, Instant{std::chrono::milliseconds{100} + Duration{1}});
  static_cast<void>(bench.loop.advance(overdue - Duration{1}));
  EXPECT_FALSE(bench.take_fault().has_value());
  static_cast<void>(bench.loop.advance(overdue));
  const auto fault = bench.take_fault();
  ASSERT_TRUE(fault.has_value());
  EXPECT_EQ(fault->fault, FaultFlags::command_age);
}

TEST(ControlLoop, CommandAgeCountsFromResumption) {
  Bench bench{Bench::settings(CouplingMode::paced), ideal_spring_rig(kStiffness_n_per_m)};
  bench.start();
  bench.target(1, 0.0004, 0.1);
  bench.ask(loop_request::Pause{});
  for (int i = 0; i < 1000; ++i) bench.advance();
  EXPECT_FALSE(bench.take_fault().has_value());
  bench.ask(loop_request::Resume{});
  for (int i = 0; i < 100; ++i) bench.advance();
  EXPECT_FALSE(bench.take_fault().has_value());
  bench.advance();
  bench.advance();
  EXPECT_TRUE(bench.take_fault().has_value());
}

TEST(ControlLoop, CatchesUpMissedControlPeriods) {
  Bench bench{Bench::settings(CouplingMode::paced), ideal_spring_rig(kStiffness_n_per_m)};
  bench.ask(loop_request::Arm{});
  bench.advance();
  bench.now += 19 * kPeriod;
  bench.advance();
  ASSERT_EQ(bench.rig.commands.size(), 21U);
  for (std::size_t i = 0; i < bench.rig.commands.size(); ++i) {
    EXPECT_EQ(bench.rig.commands[i].sample, static_cast<std::int64_t>(i));
    EXPECT_DOUBLE_EQ(bench.rig.commands[i].time_s, static_cast<double>(i) * kPeriod_s);
  }
}

TEST(ControlLoop, RecordsEveryPeriodInNamedColumns) {
  Bench bench{Bench::settings(CouplingMode::lockstep, 2), [](const ActuatorCommand& command, RigFeedback& feedback) {
                feedback.displacement_m = 0.5 * command.displacement_m;
                feedback.force_n = SiteVector::Constant(2, 7.0);
                feedback.force_n[1] = 8.0;
                return RigStatus::healthy;
              }};
  bench.start();
  bench.target(1, 0.0004, 0.1);
  bench.advance();
  ASSERT_EQ(bench.record.size(), 1U + kPeriodsPerStep);
  const std::size_t last = bench.record.size() - 1;
  const auto value = [&](const char* column) { return bench.record.at(last, bench.record.column(column)); };
  EXPECT_EQ(value("sample"), kPeriodsPerStep);
  EXPECT_DOUBLE_EQ(value("time_s"), kStep_s);
  EXPECT_DOUBLE_EQ(value("model_time_s"), kStep_s);
  for (const char* suffix : {"_1", "_2"}) {
    EXPECT_DOUBLE_EQ(value((std::string{"target_displacement_m"} + suffix).c_str()), 0.0004);
    EXPECT_DOUBLE_EQ(value((std::string{"command_displacement_m"} + suffix).c_str()), 0.0004);
    EXPECT_DOUBLE_EQ(value((std::string{"measured_displacement_m"} + suffix).c_str()), 0.0002);
  }
  EXPECT_EQ(value("measured_force_n_1"), 7.0);
  EXPECT_EQ(value("measured_force_n_2"), 8.0);
  EXPECT_EQ(value("compensated_force_n_1"), 7.0);
  // The force is constant: the integral over the error at its end, half the target at each dof.
  EXPECT_NEAR(value("energy_error_j"), (7.0 + 8.0) * 0.0002, 1e-15);
  EXPECT_EQ(value("faults"), 0.0);
  // The last period of a step in which the target moves by 0.0004 m.
  EXPECT_NEAR(value("target_velocity_m_per_s_1"), 0.1, 1e-12);
  EXPECT_EQ(value("follows_targets"), 1.0);
  EXPECT_EQ(value("command_age_s"), 0.0);
  EXPECT_EQ(ControlLoop::control_layout(1).columns.size(), 15U);
  EXPECT_EQ(ControlLoop::control_layout(1).columns[4].name, "command_displacement_m");
}

}  // namespace
}  // namespace hybridtest
