#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/random.hpp"
#include "tests/simulation/drawn_case.hpp"
#include "tests/simulation/invariants.hpp"
#include "tests/simulation/kept_simulation.hpp"

/// One kind of fault at a time, and the exact outcome it must have.
namespace hybridtest {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Duration kLease = seconds{2};
constexpr Duration kHeartbeat = kLease / 4;

/// Long command timeouts, so that the lease ends the test.
Scenario two_storeys(std::vector<std::string> overrides = {}) {
  overrides.insert(overrides.begin(),
                   {kPulse, "time.duration_s=1.0", "substructures[storey_1].limits.command_age_s=10.0"});
  return shipped_scenario("two_storey_one_site", overrides);
}

/// On a slow network: the test steps from about 0.6 s to 4.6 s of simulated time.
SimulationSettings slow_network() {
  SimulationSettings settings;
  settings.network.latency = milliseconds{2};
  return settings;
}

const Event* find(const KeptSimulation& run, EventCode code, std::string_view source) {
  const auto found = std::ranges::find_if(
      run.events, [&](const Event& event) { return event.code == code && event.source.view() == source; });
  return found == run.events.end() ? nullptr : &*found;
}

void expect_sound(const KeptSimulation& run, const Scenario& scenario) {
  EXPECT_EQ(steps_violated(run, scenario), Violations{}) << run.log();
  EXPECT_EQ(limits_violated(run, scenario), Violations{}) << run.log();
  EXPECT_EQ(energy_violated(run, scenario), Violations{}) << run.log();
}

double final_command_m(const KeptSimulation& run, const std::string& site) {
  return run.table(site, "control").column_values("command_displacement_m").back();
}

class Killed : public testing::TestWithParam<std::string> {};

TEST_P(Killed, EndsTheTestWithinTheLease) {
  const Scenario scenario = two_storeys();
  const KeptSimulation reference = keep_simulation(scenario, SimulationSettings{});
  Random random{7};
  for (int i = 0; i < 15; ++i) {
    SimulationSettings settings = slow_network();
    settings.seed = static_cast<std::uint64_t>(i);
    settings.clock_drift_ppm_max = 0.0;
    const Duration killed_at = milliseconds{1200 + static_cast<std::int64_t>(random.below(3000))};
    settings.kills.push_back({GetParam(), killed_at});
    SCOPED_TRACE(to_seconds(killed_at));
    const KeptSimulation run = keep_simulation(scenario, settings);
    EXPECT_EQ(run.result.coordinator.reason, StopReason::participant_lost);
    const Event* lost = find(run, EventCode::participant_lost, "coordinator");
    ASSERT_NE(lost, nullptr) << run.log();
    EXPECT_EQ(lost->subject.view(), GetParam());
    // Its last heartbeat came up to one interval before, and clocks start within 0.1 s.
    EXPECT_GE(lost->clock + milliseconds{100}, killed_at + kLease - kHeartbeat);
    EXPECT_LE(lost->clock, killed_at + kLease + milliseconds{5});
    for (const SimulatedOutcome& outcome : run.result.participants) {
      if (outcome.was_killed) continue;
      EXPECT_TRUE(outcome.is_done) << outcome.participant;
      EXPECT_EQ(outcome.reason, StopReason::participant_lost) << outcome.participant;
    }
    if (GetParam() != "storey_1") {
      EXPECT_EQ(final_command_m(run, "storey_1"), 0.0);
    }
    expect_sound(run, scenario);
    EXPECT_EQ(history_violated(run, reference), Violations{});
  }
}

INSTANTIATE_TEST_SUITE_P(Substructures, Killed, testing::Values("storey_1", "storey_2"),
                         [](const auto& id) { return id.param; });

TEST(KilledSubstructure, SiteHoldsAndCoordinatorNamesTheSilentOne) {
  const Scenario scenario = two_storeys({"substructures[storey_1].limits.command_age_s=0.5"});
  SimulationSettings settings = slow_network();
  settings.kills.push_back({"storey_2", milliseconds{2000}});
  const KeptSimulation run = keep_simulation(scenario, settings);
  // The site's overdue command is the consequence; the silent participant is the cause.
  EXPECT_EQ(run.result.coordinator.reason, StopReason::participant_lost);
  EXPECT_EQ(run.count(EventCode::answer_overdue, "coordinator", "storey_2"), 1U);
  EXPECT_EQ(run.count(EventCode::command_overdue, "storey_1"), 1U);
  EXPECT_GE(run.count(EventCode::command_repeated, "coordinator", "storey_2"), 1U);
  EXPECT_EQ(run.count(EventCode::command_repeated, "coordinator", "storey_1"), 0U);
  EXPECT_EQ(final_command_m(run, "storey_1"), 0.0);
  expect_sound(run, scenario);
}

TEST(KilledCoordinator, SiteHoldsThenReturnsAndReportsBoth) {
  for (const char* mode : {"lockstep", "paced"}) {
    SCOPED_TRACE(mode);
    const Scenario scenario = two_storeys(
        {std::string{"time.mode="} + mode, "time.duration_s=1.2", "substructures[storey_1].limits.command_age_s=0.4"});
    Random random{8};
    for (int i = 0; i < 10; ++i) {
      SimulationSettings settings;
      settings.seed = static_cast<std::uint64_t>(i);
      settings.clock_drift_ppm_max = 0.0;
      settings.network.latency = milliseconds{std::string_view{mode} == "lockstep" ? 2 : 0};
      const Duration killed_at = milliseconds{800 + static_cast<std::int64_t>(random.below(500))};
      settings.kills.push_back({"coordinator", killed_at});
      const KeptSimulation run = keep_simulation(scenario, settings);
      const Event* overdue = find(run, EventCode::command_overdue, "storey_1");
      ASSERT_NE(overdue, nullptr) << run.log();
      // One control period after the limit; clocks start within 0.1 s of simulated time.
      EXPECT_LE(overdue->clock, killed_at + milliseconds{400 + 6});
      EXPECT_GT(overdue->values[0], 0.4);
      EXPECT_EQ(overdue->values[1], 0.4);
      EXPECT_EQ(run.count(EventCode::coordinator_lost, "storey_1"), 1U);
      EXPECT_EQ(run.count(EventCode::coordinator_lost, "storey_2"), 1U);
      for (const char* id : {"storey_1", "storey_2"}) {
        EXPECT_TRUE(run.outcome(id).is_done);
        EXPECT_EQ(run.outcome(id).reason, StopReason::coordinator_lost);
      }
      EXPECT_EQ(final_command_m(run, "storey_1"), 0.0);
      expect_sound(run, scenario);
    }
  }
}

TEST(KilledBeforeTheTest, OthersNameTheMissingParticipant) {
  const Scenario scenario = two_storeys();
  for (const char* killed : {"coordinator", "storey_1", "storey_2"}) {
    SCOPED_TRACE(killed);
    SimulationSettings settings;
    settings.kills.push_back({killed, Duration{}});
    const KeptSimulation run = keep_simulation(scenario, settings);
    for (const SimulatedOutcome& outcome : run.result.participants) {
      if (outcome.was_killed) continue;
      EXPECT_EQ(outcome.reason, StopReason::not_assembled) << outcome.participant;
    }
    EXPECT_GE(run.count(EventCode::participant_missing, {}, killed), 1U);
    EXPECT_LE(run.result.simulated_time, seconds{36}) << "discovery timeout of 30 s, and the leases";
  }
}

TEST(Outage, ShorterThanLeaseIsHarmlessAndRetriesAreCounted) {
  const Scenario scenario = two_storeys();
  const KeptSimulation reference = keep_simulation(scenario, SimulationSettings{});
  for (const char* cut_off : {"coordinator", "storey_1", "storey_2"}) {
    for (const int length_ms : {300, 600, 900}) {
      SCOPED_TRACE(std::string{cut_off} + " " + std::to_string(length_ms));
      SimulationSettings settings = slow_network();
      settings.network.outages.push_back({cut_off, milliseconds{1500}, milliseconds{1500 + length_ms}});
      const KeptSimulation run = keep_simulation(scenario, settings);
      EXPECT_EQ(run.result.coordinator.reason, StopReason::completed) << run.log();
      EXPECT_EQ(history_violated(run, reference), Violations{});
      expect_sound(run, scenario);
      const auto attempts = run.table("coordinator", "exchanges").column_values("attempts");
      // Repeats come at least every 200 ms until the outage is over, and at first eight times every 20 ms.
      const double most = *std::ranges::max_element(attempts);
      EXPECT_GE(most, std::floor(length_ms / 200.0));
      EXPECT_LE(most, 2.0 + length_ms / 20.0);
      EXPECT_LE(most, 2.0 + 8.0 + 8.0 + length_ms / 80.0);
      EXPECT_GE(run.count(EventCode::command_repeated, "coordinator"), 1U);
      EXPECT_GT(run.result.network.lost, 0U);
    }
  }
}

TEST(Outage, LongerThanLeaseEndsTestOnBothSides) {
  const Scenario scenario = two_storeys();
  const KeptSimulation reference = keep_simulation(scenario, SimulationSettings{});
  for (const char* cut_off : {"storey_1", "storey_2"}) {
    SCOPED_TRACE(cut_off);
    SimulationSettings settings = slow_network();
    settings.network.outages.push_back({cut_off, milliseconds{1500}, milliseconds{20000}});
    const KeptSimulation run = keep_simulation(scenario, settings);
    EXPECT_EQ(run.result.coordinator.reason, StopReason::participant_lost);
    EXPECT_EQ(run.count(EventCode::participant_lost, "coordinator", cut_off), 1U);
    EXPECT_EQ(run.count(EventCode::coordinator_lost, cut_off), 1U);
    EXPECT_EQ(run.outcome(cut_off).reason, StopReason::coordinator_lost);
    for (const SimulatedOutcome& outcome : run.result.participants) EXPECT_TRUE(outcome.is_done);
    EXPECT_EQ(final_command_m(run, "storey_1"), 0.0);
    EXPECT_EQ(history_violated(run, reference), Violations{});
    expect_sound(run, scenario);
  }
}

TEST(Interlock, EndsTheTestAndTheSiteReturnsToZero) {
  for (const char* mode : {"lockstep", "paced"}) {
    SCOPED_TRACE(mode);
    const Scenario scenario = two_storeys({std::string{"time.mode="} + mode, "excitation.scale=4.0"});
    const KeptSimulation run = keep_simulation(scenario, SimulationSettings{});
    EXPECT_EQ(run.result.coordinator.reason, StopReason::interlock);
    EXPECT_EQ(run.outcome("storey_1").faults, FaultFlags::displacement_limit);
    EXPECT_EQ(run.count(EventCode::interlock_tripped, "storey_1", "displacement_limit"), 1U);
    EXPECT_EQ(final_command_m(run, "storey_1"), 0.0);
    expect_sound(run, scenario);
    // After the trip no command grows.
    const auto faults = run.table("storey_1", "control").column_values("faults");
    const auto commands_m = run.table("storey_1", "control").column_values("command_displacement_m");
    const auto tripped =
        static_cast<std::size_t>(std::ranges::find_if(faults, [](double f) { return f != 0.0; }) - faults.begin());
    ASSERT_LT(tripped, faults.size());
    for (std::size_t i = tripped + 1; i < commands_m.size(); ++i) {
      ASSERT_LE(std::abs(commands_m[i]), std::abs(commands_m[i - 1]));
    }
  }
}

TEST(Uncompensated, EnergyErrorTripsInterlock) {
  // 20 ms of delay on a period of 0.8 s add energy to the structure until the interlock ends the test.
  const std::vector<std::string> delayed{
      kPulse,
      "time.duration_s=1.2",
      "excitation.scale=0.5",
      "substructures[storey_1].rig.transfer_system={type: delay, delay_s: 0.020}",
      "substructures[storey_1].rig.specimen={type: elastic, stiffness_n_per_m: 4.0e6}",
      "substructures[storey_1].limits.energy_error_ratio=0.5"};
  std::vector<std::string> uncompensated = delayed;
  uncompensated.push_back("substructures[storey_1].compensator={type: none}");
  std::vector<std::string> compensated = delayed;
  compensated.push_back(
      "substructures[storey_1].compensator={type: polynomial_displacement, order: 3, delay_s: 0.020}");
  const Scenario without = shipped_scenario("two_storey_one_site", uncompensated);
  const Scenario with = shipped_scenario("two_storey_one_site", compensated);
  const KeptSimulation ended = keep_simulation(without, SimulationSettings{});
  EXPECT_EQ(ended.result.coordinator.reason, StopReason::interlock);
  EXPECT_EQ(ended.outcome("storey_1").faults, FaultFlags::energy_error) << ended.log();
  EXPECT_EQ(keep_simulation(with, SimulationSettings{}).result.coordinator.reason, StopReason::completed);
}

/// Paced runs with an ideal rig without noise, so that the coupling causes every difference.
class Paced : public testing::Test {
 protected:
  static Scenario ideal(std::vector<std::string> overrides = {}) {
    overrides.insert(overrides.begin(),
                     {kPulse, "time.duration_s=0.6", "time.mode=paced", "excitation.scale=0.5",
                      "substructures[storey_1].rig.transfer_system={type: ideal}",
                      "substructures[storey_1].rig.specimen={type: elastic, stiffness_n_per_m: 4.0e6}",
                      "substructures[storey_1].rig.sensors={displacement_noise_m: 0.0, force_noise_n: 0.0, seed: 1}",
                      "substructures[storey_1].compensator={type: none}"});
    return shipped_scenario("two_storey_one_site", overrides);
  }
  static std::vector<MeasurementFlags> flags(const KeptSimulation& run) {
    std::vector<MeasurementFlags> flags;
    const KeptRows& steps = run.table("storey_1", "steps");
    for (const double value : steps.column_values("flags")) {
      flags.push_back(static_cast<MeasurementFlags>(static_cast<std::uint32_t>(value)));
    }
    return flags;
  }
  static std::size_t count(const std::vector<MeasurementFlags>& flags, MeasurementFlags flag) {
    return static_cast<std::size_t>(
        std::ranges::count_if(flags, [flag](MeasurementFlags its) { return any(its & flag); }));
  }
  /// Largest difference of floor 1, as a share of its peak.
  static double difference(const KeptSimulation& a, const KeptSimulation& b) {
    const auto left = a.table("coordinator", "steps").column_values("displacement_floor_1_m");
    const auto right = b.table("coordinator", "steps").column_values("displacement_floor_1_m");
    double largest = 0.0;
    double peak = 0.0;
    for (std::size_t i = 0; i < std::min(left.size(), right.size()); ++i) {
      largest = std::max(largest, std::abs(left[i] - right[i]));
      peak = std::max(peak, std::abs(right[i]));
    }
    return largest / peak;
  }
};

TEST_F(Paced, KeepsTimeAndMotionOfLockstepOnFastNetwork) {
  const Scenario paced = ideal({"time.time_scale=2.0"});
  const KeptSimulation run = keep_simulation(paced, SimulationSettings{});
  ASSERT_EQ(run.result.coordinator.reason, StopReason::completed);
  // Every target arrives before 60 % of its step has passed: none is late.
  EXPECT_EQ(count(flags(run), MeasurementFlags::late), 0U);
  EXPECT_EQ(count(flags(run), MeasurementFlags::held), 0U);
  // Stepping runs at most one step ahead: 600 steps of 2 ms, less that one.
  EXPECT_NEAR(to_seconds(run.result.coordinator.running_time), 1.2, 0.004);
  const KeptSimulation lockstep = keep_simulation(ideal({"time.mode=lockstep"}), SimulationSettings{});
  // Each is measured at its target within the rounding of the path: some 1e-16 of a
  // millimetre's path per step, carried on by 600 steps.
  EXPECT_LT(difference(run, lockstep), 1e-11);
}

TEST_F(Paced, LateTargetsSlowActuatorWithoutJumps) {
  const Scenario scenario = ideal();
  SimulationSettings settings;
  settings.network.latency = microseconds{600};  // the round trip takes more than a step
  const KeptSimulation run = keep_simulation(scenario, settings);
  ASSERT_EQ(run.result.coordinator.reason, StopReason::completed);
  EXPECT_GT(count(flags(run), MeasurementFlags::late), 500U);
  EXPECT_GT(to_seconds(run.result.coordinator.running_time), 0.6);
  expect_sound(run, scenario);
  // Path time is set back to 60 % of the step and passes the target within the next sampling
  // interval of 50 %, so that straight interpolation measures up to (1.1 - 1.0) 0.8 = 8 % of a
  // step off: at 8 rad/s a force that is 8e-5 s early, 3e-4 of damping ratio, over the half cycle
  // of this test 1e-3 of the amplitude.
  const KeptSimulation lockstep = keep_simulation(ideal({"time.mode=lockstep"}), SimulationSettings{});
  EXPECT_LT(difference(run, lockstep), 2e-3);
}

TEST_F(Paced, ActuatorHoldsDuringOutageAndContinues) {
  const Scenario scenario = ideal();
  SimulationSettings settings;
  settings.network.outages.push_back({"coordinator", milliseconds{600}, milliseconds{1100}});
  const KeptSimulation run = keep_simulation(scenario, settings);
  ASSERT_EQ(run.result.coordinator.reason, StopReason::completed) << run.log();
  EXPECT_GE(count(flags(run), MeasurementFlags::held), 1U);
  EXPECT_LE(count(flags(run), MeasurementFlags::held), 3U);
  EXPECT_GE(to_seconds(run.result.coordinator.running_time), 0.6 + 0.4);
  expect_sound(run, scenario);
  // While it held, the actuator did not stand still at once and did not overshoot the step.
  const KeptRows& control = run.table("storey_1", "control");
  const auto model_time_s = control.column_values("model_time_s");
  EXPECT_TRUE(std::ranges::is_sorted(model_time_s) ||
              std::ranges::adjacent_find(model_time_s, [](double a, double b) { return b < a - 0.4e-3; }) ==
                  model_time_s.end())
      << "path time is set back by 40 % of a step at most";
}

TEST_F(Paced, OutageBeyondCommandAgeNamesTheSilentOne) {
  const Scenario scenario = ideal({"substructures[storey_1].limits.command_age_s=0.3"});
  SimulationSettings settings;
  settings.network.outages.push_back({"storey_2", milliseconds{600}, milliseconds{1500}});
  const KeptSimulation run = keep_simulation(scenario, settings);
  // The site's overdue command is the consequence; the silent participant is the cause.
  EXPECT_EQ(run.result.coordinator.reason, StopReason::participant_lost);
  EXPECT_EQ(run.count(EventCode::answer_overdue, "coordinator", "storey_2"), 1U);
  EXPECT_EQ(run.count(EventCode::command_overdue, "storey_1"), 1U);
  EXPECT_EQ(run.outcome("storey_1").faults, FaultFlags::command_age);
  // It holds until it receives the stop, then returns.
  const auto faults = run.table("storey_1", "control").column_values("faults");
  const auto commands_m = run.table("storey_1", "control").column_values("command_displacement_m");
  const auto tripped =
      static_cast<std::size_t>(std::ranges::find_if(faults, [](double f) { return f != 0.0; }) - faults.begin());
  ASSERT_LT(tripped + 1, faults.size());
  EXPECT_NE(commands_m[tripped], 0.0);
  EXPECT_EQ(commands_m.back(), 0.0);
  expect_sound(run, scenario);
}

TEST_F(Paced, ClockDriftIsCompensated) {
  // The site's clock may be slower than the coordinator's: targets wait, at most one ahead.
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Scenario scenario = ideal({"time.duration_s=1.0"});
    SimulationSettings settings;
    settings.seed = seed;
    settings.clock_drift_ppm_max = 20000.0;  // 20 ms in a test of one second: twenty steps
    const KeptSimulation run = keep_simulation(scenario, settings);
    EXPECT_EQ(run.result.coordinator.reason, StopReason::completed) << run.log();
    expect_sound(run, scenario);
  }
}

TEST_F(Paced, LongStepIsNotRetried) {
  const Scenario scenario =
      ideal({"time.duration_s=0.02", "time.time_scale=1000.0", "substructures[storey_1].limits.command_age_s=5.0"});
  const KeptSimulation run = keep_simulation(scenario, SimulationSettings{});
  EXPECT_EQ(run.result.coordinator.reason, StopReason::completed) << run.log();
  EXPECT_EQ(run.count(EventCode::command_repeated), 0U);
}

}  // namespace
}  // namespace hybridtest
