#include "experimental_site/interlocks.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/random.hpp"

namespace hybridtest {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kPeriod_s = 1.0e-3;

SiteVector one(double value) { return SiteVector::Constant(1, value); }

const SiteLimits kLimits{.displacement_m = 0.1,
                         .velocity_m_per_s = 1.0,
                         .force_n = 1e5,
                         .tracking_error_m = 0.005,
                         .energy_error_ratio = 0.5,
                         .command_age_s = 1.0,
                         .displacement_step_m = 0.002,
                         .force_step_n = 500.0,
                         .stuck_samples = 20,
                         .stuck_while_moving_m = 1e-4,
                         .tracking_indicator = 0.3};

/// A site in the middle of a test, handed one control sample after the other.
class Story {
 public:
  explicit Story(const SiteLimits& judged_limits = kLimits) : limits{judged_limits} {}

  /// One control period on.
  const InterlockVerdict& sample() {
    verdict = judge(limits, rules,
                    {phase, target, velocity, command, measured, force, energy_ratio, lag_sine, age_s, expects_commands,
                     rig_fault, emergency_stop, true, kPeriod_s},
                    state);
    for (int i = 0; i < verdict.trip_count; ++i) trips.push_back(verdict.trips[static_cast<std::size_t>(i)]);
    time_s += kPeriod_s;
    return verdict;
  }
  /// The same values for so long.
  void wait(double duration_s) {
    limits.stuck_samples.reset();
    for (const double end_s = time_s + duration_s; time_s < end_s;) sample();
  }
  InterlockRule& rule(InterlockKind kind) { return rules[static_cast<std::size_t>(kind)]; }

  SiteLimits limits;
  InterlockRules rules = default_interlock_rules();
  InterlockState state;
  SitePhase phase = SitePhase::running;
  SiteVector target = one(0.01);
  SiteVector velocity = one(0.1);
  SiteVector command = one(0.012);
  SiteVector measured = one(0.0095);
  SiteVector force = one(1000.0);
  double energy_ratio = 0.1;
  double lag_sine = 0.1;
  double age_s = 0.1;
  bool expects_commands = true;
  bool rig_fault = false;
  bool emergency_stop = false;
  double time_s = 0.0;
  InterlockVerdict verdict;
  std::vector<InterlockTrip> trips;
};

TEST(InterlocksTest, DoNotTripWithinLimits) {
  Story story;
  for (int i = 0; i < 1000; ++i) {
    story.measured[0] += 1e-9;  // a live sensor is never quite still
    story.force[0] += 1e-3;
    ASSERT_EQ(story.sample().action, SafetyAction::none);
  }
  EXPECT_TRUE(story.trips.empty());
}

struct Case {
  InterlockKind kind;
  const char* what;
  void (*change)(Story&);
  SafetyAction action;
  double observed;  // NaN where there is nothing to measure
};

class InterlockCases : public testing::TestWithParam<Case> {};

TEST_P(InterlockCases, TripAtTheSampleThatExceedsTheLimit) {
  Story story;
  story.sample();
  GetParam().change(story);
  const InterlockVerdict verdict = story.sample();
  ASSERT_EQ(verdict.trip_count, 1);
  EXPECT_EQ(verdict.trips[0].kind, GetParam().kind);
  EXPECT_EQ(verdict.trips[0].action, GetParam().action);
  EXPECT_TRUE(verdict.trips[0].is_final);
  EXPECT_EQ(verdict.action, GetParam().action);
  if (!std::isnan(GetParam().observed)) {
    EXPECT_DOUBLE_EQ(verdict.trips[0].observed, GetParam().observed);
  }
  // It is said once, and stays in force however long the story goes on well.
  Story healthy;
  story.target = healthy.target;
  story.velocity = healthy.velocity;
  story.measured = healthy.measured;
  story.force = healthy.force;
  story.limits.displacement_step_m.reset();
  story.limits.force_step_n.reset();
  story.wait(1.0);
  EXPECT_EQ(story.trips.size(), 1U);
  EXPECT_EQ(story.verdict.action, GetParam().action);
}

INSTANTIATE_TEST_SUITE_P(
    All, InterlockCases,
    testing::Values(
        Case{InterlockKind::displacement, "target",
             [](Story& s) {
               s.target = one(-0.1001);
               s.limits.tracking_error_m.reset();
             },
             SafetyAction::ramp_to_zero, 0.1001},
        Case{InterlockKind::displacement, "measured",
             [](Story& s) {
               s.measured = one(0.1001);
               s.limits.tracking_error_m.reset();
               s.limits.displacement_step_m.reset();
             },
             SafetyAction::ramp_to_zero, 0.1001},
        Case{InterlockKind::force, "force",
             [](Story& s) {
               s.force = one(-1.01e5);
               s.limits.force_step_n.reset();
             },
             SafetyAction::ramp_to_zero, 1.01e5},
        Case{InterlockKind::velocity, "velocity", [](Story& s) { s.velocity = one(1.01); }, SafetyAction::ramp_to_zero,
             1.01},
        Case{InterlockKind::tracking_error, "tracking",
             [](Story& s) {
               s.measured = one(0.0041);
               s.limits.displacement_step_m.reset();
             },
             SafetyAction::ramp_to_zero, 0.01 - 0.0041},
        Case{InterlockKind::energy_error, "energy", [](Story& s) { s.energy_ratio = -0.51; },
             SafetyAction::ramp_to_zero, 0.51},
        Case{InterlockKind::tracking_indicator, "lag", [](Story& s) { s.lag_sine = 0.31; }, SafetyAction::ramp_to_zero,
             0.31},
        Case{InterlockKind::tracking_indicator, "lead", [](Story& s) { s.lag_sine = -0.31; },
             SafetyAction::ramp_to_zero, 0.31},
        Case{InterlockKind::command_age, "age", [](Story& s) { s.age_s = 1.01; }, SafetyAction::hold, 1.01},
        Case{InterlockKind::displacement_step, "displacement_step", [](Story& s) { s.measured = one(0.0095 + 0.0021); },
             SafetyAction::hold, 0.0095 + 0.0021 - 0.0095},
        Case{InterlockKind::force_step, "force_step", [](Story& s) { s.force = one(499.0); }, SafetyAction::hold,
             501.0},
        Case{InterlockKind::rig_status, "rig", [](Story& s) { s.rig_fault = true; }, SafetyAction::hold, kNan},
        Case{InterlockKind::emergency_stop, "emergency", [](Story& s) { s.emergency_stop = true; },
             SafetyAction::release, kNan},
        Case{InterlockKind::not_finite, "nan_force", [](Story& s) { s.force = one(kNan); }, SafetyAction::hold, kNan},
        Case{InterlockKind::not_finite, "nan_command", [](Story& s) { s.command = one(kNan); }, SafetyAction::hold,
             kNan},
        Case{InterlockKind::not_finite, "nan_target", [](Story& s) { s.target = one(kNan); }, SafetyAction::hold, kNan},
        Case{InterlockKind::not_finite, "infinite",
             [](Story& s) { s.measured = one(std::numeric_limits<double>::infinity()); }, SafetyAction::hold, kNan}),
    [](const auto& test) { return test.param.what; });

TEST(InterlocksTest, EachHasItsOwnNameAndFault) {
  std::set<std::string_view> names;
  std::set<std::uint32_t> faults;
  for (std::size_t i = 0; i < kInterlockCount; ++i) {
    names.insert(name(static_cast<InterlockKind>(i)));
    faults.insert(static_cast<std::uint32_t>(fault_of(static_cast<InterlockKind>(i))));
  }
  EXPECT_EQ(names.size(), kInterlockCount);
  EXPECT_EQ(faults.size(), kInterlockCount);
}

TEST(InterlocksTest, IgnoreCommandAgeWhenNoCommandIsExpected) {
  Story story;
  story.age_s = 100.0;
  story.expects_commands = false;
  EXPECT_EQ(story.sample().action, SafetyAction::none);
}

TEST(InterlocksTest, UnsetLimitDoesNotTrip) {
  Story story{{.displacement_m = 0.1, .velocity_m_per_s = 1.0, .force_n = 1e5, .command_age_s = 1.0}};
  story.sample();
  story.measured = one(-0.05);
  story.force = one(9e4);
  story.energy_ratio = 99.0;
  story.lag_sine = 1.0;
  for (int i = 0; i < 100; ++i) {
    story.command[0] += 1e-3;
    EXPECT_EQ(story.sample().action, SafetyAction::none);
  }
}

TEST(InterlocksTest, NonFiniteValueDoesNotHideOtherTrips) {
  Story story;
  story.rule(InterlockKind::force).action = SafetyAction::release;
  story.limits.force_step_n.reset();
  story.target = one(kNan);
  EXPECT_EQ(story.sample().action, SafetyAction::hold);
  story.force = one(2e5);
  EXPECT_EQ(story.sample().action, SafetyAction::release);

  Story two;
  two.limits.tracking_error_m.reset();
  two.measured = SiteVector::Constant(2, kNan);
  two.measured[1] = 0.2;
  two.target = two.command = two.velocity = two.force = SiteVector::Zero(2);
  EXPECT_EQ(two.sample().trip_count, 2);
  EXPECT_EQ(two.verdict.trips[0].kind, InterlockKind::displacement);
  EXPECT_EQ(two.verdict.trips[1].kind, InterlockKind::not_finite);
}

TEST(InterlocksTest, ListSeveralTripsMostSevereFirst) {
  Story story;
  story.age_s = 2.0;            // hold
  story.velocity = one(3.0);    // ramp
  story.emergency_stop = true;  // release
  story.rule(InterlockKind::energy_error).action = SafetyAction::warn;
  story.energy_ratio = 3.0;
  const InterlockVerdict verdict = story.sample();
  ASSERT_EQ(verdict.trip_count, 4);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(verdict.trips[static_cast<std::size_t>(i)].action, static_cast<SafetyAction>(4 - i));
  }
  EXPECT_EQ(verdict.action, SafetyAction::release);
}

TEST(InterlocksTest, StuckSensorTripsUnderMovingCommand) {
  for (const bool is_force : {false, true}) {
    Story story;
    double command_m = 0.012;
    for (int i = 0; i < 200; ++i) {  // both stand still: no fault
      story.sample();
    }
    ASSERT_TRUE(story.trips.empty());
    int samples = 0;
    while (story.trips.empty() && samples < 100) {
      command_m += 2e-5;
      story.command = one(command_m);
      (is_force ? story.measured : story.force)[0] += 1e-6;
      story.sample();
      ++samples;
    }
    ASSERT_EQ(story.trips.size(), 1U);
    EXPECT_EQ(story.trips[0].kind, InterlockKind::stuck_sensor);
    // It had read the same for long: the samples count from when the command has moved by more than 0.1 mm.
    EXPECT_EQ(samples, 5 + 20);
  }
  // From motion, the number of samples decides.
  Story story;
  for (int i = 0; i < 50; ++i) {
    story.command[0] += 1e-3;
    story.measured[0] += 1e-3;
    story.target[0] += 1e-3;
    story.force[0] += 1.0;
    story.sample();
  }
  ASSERT_TRUE(story.trips.empty());
  story.limits.tracking_error_m.reset();
  int samples = 0;
  while (story.trips.empty() && samples < 100) {
    story.command[0] += 3e-5;
    story.force[0] += 1.0;
    story.sample();
    ++samples;
  }
  EXPECT_EQ(samples, 3 + 20);
}

TEST(InterlocksTest, LateFirstAnswerIsNoStuckSensor) {
  constexpr int kDelaySamples = 19;  // one fewer than the limit
  Story story;
  for (int i = 0; i < 200; ++i) story.sample();  // stands
  for (int i = 0; i < 100; ++i) {
    story.command[0] += 5e-4;
    if (i >= kDelaySamples) story.measured[0] += 5e-4;
    if (i >= kDelaySamples) story.force[0] += 10.0;
    story.target = story.measured;
    story.sample();
  }
  EXPECT_TRUE(story.trips.empty());
}

TEST(InterlocksTest, RepeatedReadingsOfARigFaultAreNoStuckSensor) {
  Story story;
  for (int i = 0; i < 100; ++i) {
    story.command[0] += 1e-4;
    story.rig_fault = i >= 10;  // after ten answers that did not come, fewer than the limit
    story.sample();
  }
  ASSERT_EQ(story.trips.size(), 1U);
  EXPECT_EQ(story.trips[0].kind, InterlockKind::rig_status);
}

TEST(InterlocksTest, ForceThatMayStandStillIsNotJudged) {
  for (const bool judges_force : {false, true}) {
    Story story;
    story.limits.stuck_judges_force = judges_force;
    for (int i = 0; i < 60; ++i) {  // sliding: the force stays
      story.command[0] += 1e-4;
      story.measured[0] += 1e-4;
      story.target[0] += 1e-4;
      story.sample();
    }
    EXPECT_EQ(story.trips.size(), judges_force ? 1U : 0U);
  }
}

TEST(InterlocksTest, StepLimitIgnoresNonFiniteNeighbours) {
  Story story;
  story.rule(InterlockKind::not_finite) = {SafetyAction::warn, ClearCondition::when_cleared};
  story.sample();
  story.force = one(kNan);
  story.sample();
  story.force = one(5000.0);
  story.sample();
  ASSERT_EQ(story.trips.size(), 1U);
  EXPECT_EQ(story.trips[0].kind, InterlockKind::not_finite);
  story.force = one(0.0);
  story.sample();
  ASSERT_EQ(story.trips.size(), 2U);
  EXPECT_EQ(story.trips[1].kind, InterlockKind::force_step);
}

TEST(InterlocksTest, HoldClearsAfterTenthOfASecondWithoutCause) {
  Story story;
  story.rule(InterlockKind::tracking_error) = {SafetyAction::hold, ClearCondition::when_cleared};
  story.limits.displacement_step_m.reset();
  story.measured = one(0.0);
  story.wait(1.0);
  EXPECT_EQ(story.verdict.action, SafetyAction::hold);
  EXPECT_FALSE(story.verdict.is_final);
  story.measured = one(0.0095);
  story.wait(0.09);
  EXPECT_EQ(story.verdict.action, SafetyAction::hold);
  story.measured = one(0.0);  // back before the tenth of a second is over
  story.sample();
  story.measured = one(0.0095);
  story.wait(0.0985);
  EXPECT_EQ(story.verdict.action, SafetyAction::hold);
  story.wait(0.003);
  EXPECT_EQ(story.verdict.action, SafetyAction::none);
  EXPECT_EQ(story.trips.size(), 1U);
}

TEST(InterlocksTest, OperatorResetTripsAgainWhileCausePersists) {
  Story story;
  story.rule(InterlockKind::energy_error) = {SafetyAction::hold, ClearCondition::operator_reset};
  story.rule(InterlockKind::tracking_indicator) = {SafetyAction::warn, ClearCondition::never};
  story.energy_ratio = 0.9;
  story.lag_sine = 0.9;
  story.wait(0.1);
  story.energy_ratio = 0.1;
  story.lag_sine = 0.1;
  story.wait(10.0);
  EXPECT_EQ(story.verdict.action, SafetyAction::hold) << "nobody has reset it";
  EXPECT_TRUE(reset_by_operator(story.rules, story.state));
  EXPECT_EQ(story.sample().action, SafetyAction::warn) << "the warning is for ever";
  EXPECT_FALSE(reset_by_operator(story.rules, story.state));
  story.energy_ratio = 0.9;
  story.sample();
  EXPECT_TRUE(reset_by_operator(story.rules, story.state));
  EXPECT_EQ(story.sample().action, SafetyAction::hold) << "its cause is still there";
  EXPECT_EQ(story.trips.size(), 4U);
}

TEST(InterlocksTest, RampAndReleaseNeverClear) {
  Story story;
  story.rule(InterlockKind::velocity) = {SafetyAction::ramp_to_zero, ClearCondition::when_cleared};
  story.velocity = one(1.1);
  story.sample();
  story.velocity = one(0.0);
  story.wait(1.0);
  EXPECT_FALSE(reset_by_operator(story.rules, story.state));
  EXPECT_EQ(story.sample().action, SafetyAction::ramp_to_zero);
  EXPECT_TRUE(story.verdict.is_final);
}

TEST(InterlocksTest, AtRestLimitsApplyToMeasurementOnly) {
  Story story;
  story.phase = SitePhase::resting;
  story.target = one(3.0);
  story.velocity = one(30.0);
  story.energy_ratio = 3.0;
  story.lag_sine = 1.0;
  EXPECT_EQ(story.sample().action, SafetyAction::none);
  story.force = one(2e5);
  story.limits.force_step_n.reset();
  EXPECT_EQ(story.sample().action, SafetyAction::ramp_to_zero);
}

TEST(InterlocksTest, RuleWithoutActionDoesNotTrip) {
  Story story;
  story.rule(InterlockKind::velocity).action = SafetyAction::none;
  story.velocity = one(9.0);
  EXPECT_EQ(story.sample().trip_count, 0);
}

/// Mostly within the limit, sometimes above it, rarely not finite.
double drawn(Random& random, double limit) {
  if (random.below(40) == 0) return kNan;
  return random.uniform(-1.0, 1.0) * limit * (random.below(10) == 0 ? 2.0 : 0.95);
}

SiteVector two(Random& random, double limit) {
  const double first = drawn(random, limit);
  return SiteVector{{first, drawn(random, limit)}};
}

/// judge() passes nearly all samples in one look at all values; level_of() has each interlock by itself.
TEST(InterlocksTest, TripWhereTheirLevelIsAboveTheLimit) {
  Random random{1, 0};
  std::array<int, kInterlockCount> trips{};
  constexpr int kSamples = 20'000;
  int without_trip = 0;
  for (int i = 0; i < kSamples; ++i) {
    Story story;
    story.phase = random.below(2) == 0 ? SitePhase::running : SitePhase::resting;
    story.expects_commands = random.below(2) == 0;
    story.target = two(random, kLimits.displacement_m);
    story.velocity = two(random, kLimits.velocity_m_per_s);
    story.command = two(random, kLimits.displacement_m);
    story.measured = story.target + two(random, *kLimits.tracking_error_m);
    story.force = two(random, kLimits.force_n);
    story.energy_ratio = drawn(random, *kLimits.energy_error_ratio);
    story.lag_sine = drawn(random, *kLimits.tracking_indicator);
    story.age_s = drawn(random, kLimits.command_age_s);
    story.state.has_sample = true;
    story.state.measured_displacement_m = story.measured + two(random, *kLimits.displacement_step_m);
    story.state.measured_force_n = story.force + two(random, *kLimits.force_step_n);
    const InterlockState before = story.state;
    std::set<InterlockKind> tripped;
    story.sample();
    for (const InterlockTrip& trip : story.trips) tripped.insert(trip.kind);
    without_trip += tripped.empty() ? 1 : 0;

    const InterlockInput input{story.phase,
                               story.target,
                               story.velocity,
                               story.command,
                               story.measured,
                               story.force,
                               story.energy_ratio,
                               story.lag_sine,
                               story.age_s,
                               story.expects_commands,
                               false,
                               false,
                               true,
                               kPeriod_s};
    for (std::size_t k = 0; k < kInterlockCount; ++k) {
      const auto kind = static_cast<InterlockKind>(k);
      const std::optional<InterlockLevel> level =
          level_of(kind, kLimits, input, before.measured_displacement_m, before.measured_force_n);
      bool is_above = level && level->observed > level->limit;
      if (kind == InterlockKind::not_finite) {
        is_above = !story.target.allFinite() || !story.command.allFinite() || !story.measured.allFinite() ||
                   !story.force.allFinite();
      }
      ASSERT_EQ(tripped.contains(kind), is_above) << name(kind) << " in sample " << i;
      trips[k] += is_above ? 1 : 0;
    }
  }
  EXPECT_GT(without_trip, kSamples / 50);
  // The others do not follow from the values of one sample.
  const std::set<InterlockKind> others{InterlockKind::rig_status, InterlockKind::stuck_sensor,
                                       InterlockKind::emergency_stop};
  for (std::size_t k = 0; k < kInterlockCount; ++k) {
    const auto kind = static_cast<InterlockKind>(k);
    if (others.contains(kind)) continue;
    EXPECT_GT(trips[k], 100) << name(kind);
  }
}

}  // namespace
}  // namespace hybridtest
