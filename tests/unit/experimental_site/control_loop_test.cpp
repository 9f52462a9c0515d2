#include "experimental_site/control_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "compensation/no_compensation.hpp"
#include "compensation/no_force_compensation.hpp"
#include "compensation/polynomial_displacement.hpp"
#include "core/random.hpp"
#include "core/ring_port.hpp"
#include "tests/support/kept_rows.hpp"
#include "tests/support/scripted_rig.hpp"

namespace hybridtest {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kStiffness_n_per_m = 1.0e5;
constexpr Duration kPeriod = std::chrono::milliseconds{1};
constexpr double kPeriod_s = 1.0e-3;
constexpr int kPeriodsPerStep = 4;
constexpr double kStep_s = kPeriodsPerStep * kPeriod_s;

/// A control loop at 1 kHz with steps of 4 ms, told what to do and handed the time.
class Bench {
 public:
  static ControlLoopSettings settings(CouplingMode mode, int dofs = 1) {
    ControlLoopSettings settings;
    settings.mode = mode;
    settings.dofs = dofs;
    settings.periods_per_step = kPeriodsPerStep;
    settings.step_s = kStep_s;
    settings.limits.displacement_m = 0.1;
    settings.limits.velocity_m_per_s = 0.5;
    settings.limits.force_n = 1.0e4;
    settings.limits.command_age_s = 0.1;
    settings.return_time_s = 0.2;
    return settings;
  }

  Bench(const ControlLoopSettings& settings, ScriptedRig::Answer answer, bool compensates = false)
      : settings_{settings},
        rig{std::move(answer)},
        record{ControlLoop::control_layout(settings.dofs)},
        loop{settings,
             rig,
             compensation(settings.dofs, compensates),
             EnergyErrorMonitor{kStiffness_n_per_m * InterfaceMatrix::Identity(settings.dofs, settings.dofs), 0.005},
             ControlLoopPorts{requests, reports, signals},
             record} {}

  static SiteCompensation compensation(int dofs, bool compensates) {
    SiteCompensation made;
    for (int i = 0; i < dofs; ++i) {
      if (compensates) {
        made.commands.push_back(std::make_unique<PolynomialDisplacement>(3, 8 * kPeriod, kPeriod));
      } else {
        made.commands.push_back(std::make_unique<NoCompensation>());
      }
      made.forces.push_back(std::make_unique<NoForceCompensation>());
    }
    return made;
  }

  void ask(LoopRequest::Kind kind) {
    LoopRequest request;
    request.kind = kind;
    requests.send(request);
  }
  void target(Step step, double displacement_m, double velocity_m_per_s = 0.0, double acceleration_m_per_s2 = 0.0) {
    LoopRequest request;
    request.kind = LoopRequest::Kind::target;
    request.target.step = step;
    request.target.model_time_s = static_cast<double>(step) * kStep_s / settings_.time_scale;
    request.target.displacement_m = InterfaceVector::Constant(settings_.dofs, displacement_m);
    request.target.velocity_m_per_s = InterfaceVector::Constant(settings_.dofs, velocity_m_per_s);
    request.target.acceleration_m_per_s2 = InterfaceVector::Constant(settings_.dofs, acceleration_m_per_s2);
    requests.send(request);
  }
  /// Armed and started, the first target at rest.
  void start() {
    ask(LoopRequest::Kind::arm);
    ask(LoopRequest::Kind::start);
    target(0, 0.0);
    advance();
    take_reports();
  }
  /// One period later.
  Instant advance() {
    const Instant wake = loop.advance(now);
    now += kPeriod;
    return wake;
  }
  std::vector<LoopReport> take_reports() {
    std::vector<LoopReport> taken;
    LoopReport report;
    while (reports.take(report)) taken.push_back(report);
    return taken;
  }
  /// The fault among the reports that wait, if there is one.
  std::optional<LoopReport> take_fault() {
    for (const LoopReport& report : take_reports()) {
      if (report.kind == LoopReport::Kind::fault) return report;
    }
    return {};
  }
  [[nodiscard]] double command_m(std::size_t back = 0) const {
    return rig.commands[rig.commands.size() - 1 - back].displacement_m[0];
  }

  ControlLoopSettings settings_;
  RingPort<LoopRequest> requests{64};
  RingPort<LoopReport> reports{64};
  RingPort<SignalSample> signals{1024};
  ScriptedRig rig;
  KeptRows record;
  ControlLoop loop;
  Instant now{};
};

TEST(ControlLoop, StandsAtZeroBetweenArmingAndTheStart) {
  Bench bench{Bench::settings(CouplingMode::paced), ideal_spring_rig(kStiffness_n_per_m)};
  EXPECT_EQ(bench.advance(), kNever);
  EXPECT_TRUE(bench.rig.commands.empty());
  bench.ask(LoopRequest::Kind::arm);
  for (int i = 0; i < 10; ++i) bench.advance();
  const auto reports = bench.take_reports();
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_EQ(reports.front().kind, LoopReport::Kind::armed);
  EXPECT_TRUE(bench.rig.is_armed);
  ASSERT_EQ(bench.rig.commands.size(), 10U);
  for (const ActuatorCommand& command : bench.rig.commands) EXPECT_EQ(command.displacement_m[0], 0.0);
}

TEST(ControlLoop, ReportsARigThatCannotBeArmedAndMovesNothing) {
  Bench bench{Bench::settings(CouplingMode::paced), ideal_spring_rig(kStiffness_n_per_m)};
  bench.rig.on_arm = [] { throw std::runtime_error{"no pressure"}; };
  bench.ask(LoopRequest::Kind::arm);
  bench.ask(LoopRequest::Kind::start);
  bench.target(0, 0.01);
  for (int i = 0; i < 10; ++i) bench.advance();
  const auto reports = bench.take_reports();
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_EQ(reports.front().kind, LoopReport::Kind::arm_failed);
  EXPECT_EQ(reports.front().fault, FaultFlags::rig_fault);
  EXPECT_TRUE(bench.rig.commands.empty());
}

TEST(ControlLoop, MeasuresAtTheTargetItselfWithAnIdealRig) {
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
    const StepMeasurement& measured = reports.front().measurement;
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

TEST(ControlLoop, MeasuresAtALateTargetBetweenTwoSamples) {
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
  const StepMeasurement& measured = reports.front().measurement;
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

TEST_P(EveryLimit, TripsInTheControlPeriodThatPassesIt) {
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
      ASSERT_EQ(report.kind, LoopReport::Kind::measurement);
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

TEST(ControlLoop, TargetsBeyondALimitTripAndTheCommandStaysInside) {
  Bench too_far{Bench::settings(CouplingMode::paced), ideal_spring_rig(kStiffness_n_per_m)};
  too_far.start();
  too_far.target(1, 0.2);
  std::optional<LoopReport> fault;
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
  EXPECT_EQ(not_a_number.command_m(), 0.0);
}

TEST(ControlLoop, AfterValuesThatAreNotFiniteItHoldsAlsoWhenStopped) {
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
  is_broken = true;
  bench.advance();
  const double held_m = bench.command_m();
  EXPECT_GT(held_m, 0.0);
  bench.take_reports();
  bench.ask(LoopRequest::Kind::stop);
  bench.advance();
  const auto reports = bench.take_reports();
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_EQ(reports.front().kind, LoopReport::Kind::at_rest);
  EXPECT_EQ(bench.rig.stops, 1);
  for (int i = 0; i < 10; ++i) bench.advance();
  EXPECT_EQ(bench.command_m(), held_m);
}

TEST(ControlLoop, ReturnsToZeroAtHalfTheVelocityLimitAtMost) {
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
  bench.ask(LoopRequest::Kind::stop);
  while (bench.take_reports().empty()) bench.advance();
  double last_m = begin_m;
  double fastest_m_per_s = 0.0;
  for (std::size_t i = before; i < bench.rig.commands.size(); ++i) {
    const double command_m = bench.rig.commands[i].displacement_m[0];
    EXPECT_LE(command_m, last_m);
    fastest_m_per_s = std::max(fastest_m_per_s, (last_m - command_m) / kPeriod_s);
    last_m = command_m;
  }
  EXPECT_EQ(last_m, 0.0);
  EXPECT_LE(fastest_m_per_s, 0.25);
  // As long as it takes at that speed, T = pi a / v, to the period above.
  EXPECT_EQ(bench.rig.commands.size() - before,
            static_cast<std::size_t>(std::ceil(std::numbers::pi * begin_m / 0.5 / kPeriod_s)));
}

TEST(ControlLoop, AReturnFromZeroInNoTimeSendsZeros) {
  ControlLoopSettings settings = Bench::settings(CouplingMode::lockstep);
  settings.return_time_s = 0.0;
  Bench bench{settings, ideal_spring_rig(kStiffness_n_per_m)};
  bench.start();
  bench.ask(LoopRequest::Kind::stop);
  bench.advance();
  const auto reports = bench.take_reports();
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_EQ(reports.front().kind, LoopReport::Kind::at_rest);
  for (const ActuatorCommand& command : bench.rig.commands) EXPECT_EQ(command.displacement_m[0], 0.0);
}

TEST(ControlLoop, AnEmergencyStopEndsAllMotionAtOnce) {
  Bench bench{Bench::settings(CouplingMode::paced), ideal_spring_rig(kStiffness_n_per_m)};
  bench.start();
  bench.target(1, 0.001, 0.2);
  bench.advance();
  const std::size_t exchanges = bench.rig.commands.size();
  bench.ask(LoopRequest::Kind::emergency_stop);
  EXPECT_EQ(bench.advance(), kNever);
  EXPECT_GE(bench.rig.stops, 1);
  for (int i = 0; i < 10; ++i) bench.advance();
  EXPECT_EQ(bench.rig.commands.size(), exchanges);
  const auto reports = bench.take_reports();
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_EQ(reports.front().kind, LoopReport::Kind::at_rest);
}

TEST(ControlLoop, HoldsWhenTheNextTargetIsOverdue) {
  Bench bench{Bench::settings(CouplingMode::paced), ideal_spring_rig(kStiffness_n_per_m)};
  bench.start();
  bench.target(1, 0.0004, 0.1);
  const Instant given = bench.now;
  std::optional<LoopReport> fault;
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

TEST(ControlLoop, InLockstepWakesForAnOverdueTarget) {
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

TEST(ControlLoop, APauseIsNotOverdueAndTheAgeCountsFromTheResumption) {
  Bench bench{Bench::settings(CouplingMode::paced), ideal_spring_rig(kStiffness_n_per_m)};
  bench.start();
  bench.target(1, 0.0004, 0.1);
  bench.ask(LoopRequest::Kind::pause);
  for (int i = 0; i < 1000; ++i) bench.advance();
  EXPECT_FALSE(bench.take_fault().has_value());
  bench.ask(LoopRequest::Kind::resume);
  for (int i = 0; i < 100; ++i) bench.advance();
  EXPECT_FALSE(bench.take_fault().has_value());
  bench.advance();
  bench.advance();
  EXPECT_TRUE(bench.take_fault().has_value());
}

TEST(ControlLoop, MakesUpForControlPeriodsThatWereMissed) {
  Bench bench{Bench::settings(CouplingMode::paced), ideal_spring_rig(kStiffness_n_per_m)};
  bench.ask(LoopRequest::Kind::arm);
  bench.advance();
  bench.now += 19 * kPeriod;
  bench.advance();
  ASSERT_EQ(bench.rig.commands.size(), 21U);
  for (std::size_t i = 0; i < bench.rig.commands.size(); ++i) {
    EXPECT_EQ(bench.rig.commands[i].sample, static_cast<std::int64_t>(i));
    EXPECT_DOUBLE_EQ(bench.rig.commands[i].time_s, static_cast<double>(i) * kPeriod_s);
  }
}

TEST(ControlLoop, RecordsEveryPeriodUnderTheNamesOfItsColumns) {
  Bench bench{Bench::settings(CouplingMode::lockstep, 2), [](const ActuatorCommand& command, RigFeedback& feedback) {
                feedback.displacement_m = 0.5 * command.displacement_m;
                feedback.force_n = InterfaceVector::Constant(2, 7.0);
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
  EXPECT_EQ(ControlLoop::control_layout(1).columns.size(), 10U);
  EXPECT_EQ(ControlLoop::control_layout(1).columns[4].name, "command_displacement_m");
}

/// What goes wrong in one random sequence.
class FaultSequence {
 public:
  explicit FaultSequence(std::uint64_t seed)
      : random_{seed},
        settings_{drawn_settings()},
        bench_{settings_, [this](const ActuatorCommand& c, RigFeedback& f) { return answer(c, f); },
               random_.uniform() < 0.5} {}

  void run() {
    bench_.ask(LoopRequest::Kind::arm);
    bench_.ask(LoopRequest::Kind::start);
    bench_.target(0, 0.0);
    for (int i = 0; i < 400 && !testing::Test::HasFailure(); ++i) {
      if (random_.uniform() < 0.05) bench_.now += static_cast<int>(random_.below(10)) * kPeriod;
      interfere();
      is_passed_ = false;
      bench_.advance();
      heed_reports();
      if (is_passed_ && !has_tripped_ && !was_stopped_) ADD_FAILURE() << "a limit was passed and nothing said so";
      check_commands();
    }
  }

  [[nodiscard]] bool has_tripped() const { return has_tripped_; }

 private:
  ControlLoopSettings drawn_settings() {
    ControlLoopSettings settings = Bench::settings(
        random_.uniform() < 0.5 ? CouplingMode::paced : CouplingMode::lockstep, 1 + static_cast<int>(random_.below(2)));
    if (random_.uniform() < 0.5) settings.limits.tracking_error_m = random_.uniform(0.0005, 0.02);
    if (random_.uniform() < 0.5) settings.limits.energy_error_ratio = random_.uniform(0.05, 2.0);
    settings.return_time_s = random_.uniform() < 0.3 ? 0.0 : random_.uniform(0.0, 0.3);
    return settings;
  }

  RigStatus answer(const ActuatorCommand& command, RigFeedback& feedback) {
    place_m_.conservativeResize(settings_.dofs);
    place_m_ += 0.3 * (command.displacement_m - place_m_);
    feedback.displacement_m = place_m_;
    feedback.force_n = kStiffness_n_per_m * place_m_;
    const double draw = random_.uniform();
    const auto dof = static_cast<Eigen::Index>(random_.below(static_cast<std::uint64_t>(settings_.dofs)));
    RigStatus status = RigStatus::healthy;
    if (draw < 0.002) feedback.force_n[dof] = kNan;
    if (draw > 0.002 && draw < 0.004) feedback.displacement_m[dof] = -std::numeric_limits<double>::infinity();
    if (draw > 0.004 && draw < 0.006) feedback.force_n[dof] = 2.0e4;
    if (draw > 0.006 && draw < 0.008) feedback.displacement_m[dof] = 0.3;
    if (draw > 0.008 && draw < 0.010) status = RigStatus::fault;
    const SiteLimits& limits = settings_.limits;
    // Seen from outside, in other words than those of the interlocks.
    const bool is_fine = status == RigStatus::healthy && feedback.displacement_m.allFinite() &&
                         feedback.force_n.allFinite() &&
                         feedback.displacement_m.cwiseAbs().maxCoeff() <= limits.displacement_m &&
                         feedback.force_n.cwiseAbs().maxCoeff() <= limits.force_n;
    is_passed_ = is_passed_ || !is_fine;
    return status;
  }

  void interfere() {
    const double draw = random_.uniform();
    if (wants_target_ && draw < 0.7) {
      wants_target_ = false;
      const double bound_m = random_.uniform() < 0.02 ? 1.0 : 0.0005;
      displacement_m_ += random_.uniform(-bound_m, bound_m);
      const double velocity = random_.uniform() < 0.01 ? 100.0 : random_.uniform(-0.1, 0.1);
      const double acceleration = random_.uniform() < 0.01 ? 1.0e5 : random_.uniform(-5.0, 5.0);
      bench_.target(++step_, random_.uniform() < 0.005 ? kNan : displacement_m_, velocity, acceleration);
    }
    if (draw > 0.990) bench_.ask(LoopRequest::Kind::pause);
    if (draw > 0.980 && draw < 0.990) bench_.ask(LoopRequest::Kind::resume);
    if (draw > 0.978 && draw < 0.980) stop(LoopRequest::Kind::stop);
    if (draw > 0.977 && draw < 0.978) stop(LoopRequest::Kind::emergency_stop);
  }

  void stop(LoopRequest::Kind kind) {
    was_stopped_ = true;
    bench_.ask(kind);
  }

  void heed_reports() {
    for (const LoopReport& report : bench_.take_reports()) {
      if (report.kind == LoopReport::Kind::fault) has_tripped_ = true;
      if (report.kind == LoopReport::Kind::at_rest && !was_stopped_) ADD_FAILURE() << "at rest unasked";
      if (report.kind != LoopReport::Kind::measurement) continue;
      EXPECT_EQ(report.measurement.step, ++measured_);
      EXPECT_TRUE(report.measurement.force_n.allFinite() && report.measurement.measured_displacement_m.allFinite());
      wants_target_ = true;
    }
  }

  void check_commands() {
    const double reach_m = settings_.limits.velocity_m_per_s * kPeriod_s;
    for (; checked_ < bench_.rig.commands.size(); ++checked_) {
      const ActuatorCommand& command = bench_.rig.commands[checked_];
      for (Eigen::Index k = 0; k < settings_.dofs; ++k) {
        const double before_m = checked_ == 0 ? 0.0 : bench_.rig.commands[checked_ - 1].displacement_m[k];
        EXPECT_LE(std::abs(command.displacement_m[k]), settings_.limits.displacement_m);
        // Made by adding the reach to the one before: rounded once.
        EXPECT_LE(std::abs(command.displacement_m[k] - before_m), reach_m + kEpsilon * settings_.limits.displacement_m);
      }
      EXPECT_TRUE(command.displacement_m.allFinite());
      EXPECT_EQ(command.sample, static_cast<std::int64_t>(checked_));
    }
  }

  Random random_;
  ControlLoopSettings settings_;
  InterfaceVector place_m_ = InterfaceVector::Zero(2);
  Bench bench_;
  double displacement_m_ = 0.0;
  Step step_ = 0;
  Step measured_ = kNoStep;
  bool wants_target_ = false;
  bool is_passed_ = false;
  bool has_tripped_ = false;
  bool was_stopped_ = false;
  std::size_t checked_ = 0;
};

TEST(ControlLoop, NoCommandLeavesTheLimitsInFiveHundredRandomFaultSequences) {
  int tripped = 0;
  for (std::uint64_t seed = 1; seed <= 500 && !HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    FaultSequence sequence{seed};
    sequence.run();
    tripped += sequence.has_tripped() ? 1 : 0;
  }
  EXPECT_GE(tripped, 250) << "the sequences must provoke faults";
  EXPECT_LE(tripped, 499) << "and leave some loops running";
}

}  // namespace
}  // namespace hybridtest
