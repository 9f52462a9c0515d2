#include <gtest/gtest.h>

#include <cmath>

#include "core/random.hpp"
#include "tests/simulation/drawn_case.hpp"
#include "tests/simulation/kept_simulation.hpp"
#include "tests/support/sanitizers.hpp"

/// The coupling in real time, under simulated time: what comes late or not at all is bridged, counted and bounded.
namespace hybridtest {
namespace {

constexpr double kStep_s = 0.005;
constexpr int kMostInARow = 3;

std::vector<std::string> overrides(const std::string& mode, const std::string& type = "polynomial") {
  std::vector<std::string> set{"time.mode=" + mode,
                               "time.step_s=0.005",
                               "time.duration_s=2",
                               "substructures[storey_1].control_rate_hz=200",
                               "substructures[storey_1].compensator={type: none}",
                               "substructures[storey_1].rig.transfer_system={type: ideal}",
                               "substructures[storey_1].rig.sensors={}",
                               kPulse};
  if (mode == "real_time") set.push_back("bridging={type: " + type + ", start_anyway: true}");
  return set;
}

Scenario scenario_in(const std::string& mode, const std::string& type = "polynomial") {
  return shipped_scenario("two_storey_one_site", overrides(mode, type));
}

std::vector<double> floor_of(const KeptSimulation& kept) {
  return kept.table("coordinator", "steps").column_values("displacement_floor_1_m");
}

/// Largest difference over the peak.
double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0.0;
  double peak = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    worst = std::max(worst, std::abs(a[i] - b[i]));
    peak = std::max(peak, std::abs(b[i]));
  }
  return worst / peak;
}

std::size_t bridged(const KeptSimulation& kept) { return kept.table("coordinator", "bridges").size(); }

/// Answers without a target in time.
std::size_t missed(const KeptSimulation& kept) {
  std::size_t count = 0;
  for (const double flags : kept.table("coordinator", "exchanges").column_values("flags")) {
    count += (static_cast<std::uint32_t>(flags) & static_cast<std::uint32_t>(MeasurementFlags::missed)) != 0 ? 1U : 0U;
  }
  return count;
}

TEST(RealTime, OnASoundNetworkItIsLockstepBitForBit) {
  // One control period in a step: the path of the actuators between two targets does not matter.
  const KeptSimulation in_time = keep_simulation(scenario_in("real_time"), {.seed = 3});
  const KeptSimulation lockstep = keep_simulation(scenario_in("lockstep"), {.seed = 3});
  EXPECT_EQ(in_time.result.coordinator.reason, StopReason::completed) << in_time.log();
  EXPECT_EQ(bridged(in_time), 0U);
  EXPECT_EQ(missed(in_time), 0U);
  EXPECT_EQ(floor_of(in_time), floor_of(lockstep));
}

TEST(RealTime, StepsKeepTheTimeOfTheCoordinator) {
  const KeptSimulation kept = keep_simulation(scenario_in("real_time"), {.seed = 3});
  const std::vector<double> wall_s = kept.table("coordinator", "steps").column_values("wall_time_s");
  // A step is recorded when the command of the next one is sent, one step before its time.
  ASSERT_GE(wall_s.size(), 401U);
  const double begin_s = wall_s[1] - kStep_s;
  for (std::size_t i = 1; i + 1 < wall_s.size(); ++i) {
    ASSERT_NEAR(wall_s[i] - begin_s, kStep_s * static_cast<double>(i), 0.5 * kStep_s) << i;
  }
}

TEST(RealTime, SiteFollowsADriftingClock) {
  // 200 s with clocks that drift by up to 2000 ppm apart: without following, 0.4 s or 80 steps.
  SimulationSettings settings{.seed = 5};
  settings.clock_drift_ppm_max = 100.0;
  std::vector<std::string> set = overrides("real_time");
  set.push_back("time.duration_s=200");
  const KeptSimulation kept = keep_simulation(shipped_scenario("two_storey_one_site", set), settings);
  EXPECT_EQ(kept.result.coordinator.reason, StopReason::completed) << kept.log();
  EXPECT_EQ(bridged(kept), 0U);
  EXPECT_EQ(missed(kept), 0U);
}

TEST(RealTime, LostFirstCommandDoesNotMakeASiteLateForGood) {
  std::vector<std::string> set = overrides("real_time");
  // A round trip of half a step, and a site that starts its time within a thousandth of a second.
  set.insert(set.end(), {"time.step_s=0.0078125", "time.duration_s=0.625", "timeouts={liveliness_lease_s: 10}",
                         "substructures[storey_1].control_rate_hz=1024", "bridging.most_in_a_row=30"});
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    SimulationSettings settings{.seed = seed};
    settings.network.latency = std::chrono::milliseconds{2};
    settings.network.loss = 0.1;
    const KeptSimulation kept = keep_simulation(shipped_scenario("two_storey_one_site", set), settings);
    EXPECT_EQ(kept.result.coordinator.reason, StopReason::completed);
  }
}

TEST(RealTime, LossesAreBridgedAndCounted) {
  SimulationSettings settings{.seed = 7};
  settings.network.loss = 0.02;
  const KeptSimulation kept = keep_simulation(scenario_in("real_time"), settings);
  ASSERT_EQ(kept.result.coordinator.reason, StopReason::completed) << kept.log();
  // Two messages in each direction, each lost once in fifty: of 400 steps about 16 lack an answer of each substructure.
  EXPECT_GT(bridged(kept), 8U);
  EXPECT_LT(bridged(kept), 60U);
  std::size_t unanswered = 0;
  for (const double round_trip : kept.table("coordinator", "exchanges").column_values("round_trip_us")) {
    unanswered += std::isnan(round_trip) ? 1U : 0U;
  }
  EXPECT_EQ(unanswered, bridged(kept)) << "one row of `bridges` for each exchange without an answer";
  // Of the last step no measured force follows, so its energy is not known.
  const auto steps = kept.table("coordinator", "bridges").column_values("step");
  const auto energy_j = kept.table("coordinator", "bridges").column_values("energy_added_j");
  for (std::size_t i = 0; i < steps.size(); ++i) {
    EXPECT_EQ(std::isfinite(energy_j[i]), steps[i] < 400.0) << "step " << steps[i];
  }
}

/// Error of the displacement under losses, against the test without any.
double error_under_losses(const std::string& type, bool is_elastic, std::uint64_t seed = 7) {
  SimulationSettings lossy{.seed = seed};
  lossy.network.loss = 0.02;
  const auto displacement = [&](const std::string& mode, const SimulationSettings& settings) {
    std::vector<std::string> set = overrides(mode, type);
    if (is_elastic) {
      set.push_back("substructures[storey_1].rig.specimen={type: elastic, stiffness_n_per_m: 4.0e6}");
      set.push_back("substructures[storey_2].model={type: elastic, stiffness_n_per_m: 3.0e6}");
    }
    return floor_of(keep_simulation(shipped_scenario("two_storey_one_site", set), settings));
  };
  return difference(displacement("real_time", lossy), displacement("lockstep", {.seed = seed}));
}

/// Which steps are hit matters: the mean of some seeds.
double mean_error_under_losses(const std::string& type) {
  constexpr std::uint64_t kSeeds = 8;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) sum += error_under_losses(type, false, seed);
  return sum / kSeeds;
}

TEST(RealTime, PolynomialBridgesAreMoreAccurateThanHeldForces) {
  const double hold = mean_error_under_losses("hold");
  const double line = mean_error_under_losses("polynomial, order: 1");
  const double parabola = mean_error_under_losses("polynomial, order: 2");
  RecordProperty("hold", std::to_string(hold));
  RecordProperty("polynomial_1", std::to_string(line));
  RecordProperty("polynomial_2", std::to_string(parabola));
  EXPECT_LT(line, 0.4 * hold);
  EXPECT_LT(parabola, 0.4 * hold);
  EXPECT_LT(line, 2e-3);
}

TEST(RealTime, InitialStiffnessBridgesAnElasticSpecimen) {
  // A site that misses a command measures at a predicted displacement, which differs from the commanded one by the
  // third order of the step.
  EXPECT_LT(error_under_losses("initial_stiffness", true), 1e-5);
  EXPECT_GT(error_under_losses("hold", true), 1e-4) << "losses that do not matter test nothing";
}

TEST(RealTime, DeadSiteEndsTheTestWithinTheBridgeLimit) {
  SimulationSettings settings{.seed = 7};
  settings.kills = {{"storey_1", std::chrono::seconds{2}}};
  const KeptSimulation kept = keep_simulation(scenario_in("real_time"), settings);
  EXPECT_EQ(kept.result.coordinator.reason, StopReason::deadlines_missed) << kept.log();
  EXPECT_EQ(kept.count(EventCode::deadlines_missed, "coordinator", "storey_1"), 1U);
  EXPECT_EQ(bridged(kept), kMostInARow + 1U) << "the last one ended the test";
}

TEST(RealTime, PausedProcessOverTheLimitEndsTheTest) {
  for (const char* who : {"storey_1", "storey_2", "coordinator"}) {
    SimulationSettings settings{.seed = 7};
    settings.pauses = {{who, std::chrono::milliseconds{2500}, std::chrono::milliseconds{2500 + 60}}};
    const KeptSimulation kept = keep_simulation(scenario_in("real_time"), settings);
    EXPECT_EQ(kept.result.coordinator.reason, StopReason::deadlines_missed) << who << "\n" << kept.log();
  }
}

TEST(RealTime, PausedProcessWithinTheLimitIsBridged) {
  for (const char* who : {"storey_1", "storey_2", "coordinator"}) {
    SimulationSettings settings{.seed = 7};
    settings.pauses = {{who, std::chrono::milliseconds{2500}, std::chrono::milliseconds{2500 + 13}}};
    const KeptSimulation kept = keep_simulation(scenario_in("real_time"), settings);
    EXPECT_EQ(kept.result.coordinator.reason, StopReason::completed) << who << "\n" << kept.log();
    EXPECT_GT(bridged(kept) + missed(kept), 0U) << who;
  }
}

TEST(RealTime, SlowNetworkIsFoundBeforeTheStart) {
  SimulationSettings settings{.seed = 7};
  settings.network.latency = std::chrono::milliseconds{2};
  std::vector<std::string> set = overrides("real_time");
  set.back() = "bridging={start_anyway: false}";
  const KeptSimulation kept = keep_simulation(shipped_scenario("two_storey_one_site", set), settings);
  EXPECT_EQ(kept.result.coordinator.reason, StopReason::network_too_slow) << kept.log();
  EXPECT_EQ(kept.result.coordinator.completed_steps, 0) << "nothing has moved";
  settings.network.latency = std::chrono::milliseconds{1};
  EXPECT_EQ(keep_simulation(shipped_scenario("two_storey_one_site", set), settings).result.coordinator.reason,
            StopReason::completed);
}

/// Losses, repetitions, latencies that vary, and machines that pause, drawn by a seed.
SimulationSettings drawn_settings(std::uint64_t seed) {
  Random random{seed, 0x7265616c};
  SimulationSettings settings{.seed = seed};
  settings.network.latency = Duration{50'000 + static_cast<std::int64_t>(random.below(800'000))};
  settings.network.jitter = Duration{static_cast<std::int64_t>(random.below(1'500'000))};
  settings.network.loss = random.uniform(0.0, 0.05);
  settings.network.duplication = random.uniform(0.0, 0.05);
  settings.network.reordering = random.uniform(0.0, 0.02);
  constexpr std::array kWho{"coordinator", "storey_1", "storey_2"};
  for (std::uint64_t i = random.below(4); i > 0; --i) {
    const Duration begin{static_cast<std::int64_t>(random.below(4'000'000'000))};
    settings.pauses.push_back({kWho[random.below(kWho.size())], begin,
                               begin + Duration{static_cast<std::int64_t>(random.below(20'000'000))}});
  }
  return settings;
}

TEST(RealTime, KeepsItsInvariantsOverAThousandSeeds) {
  constexpr std::uint64_t kSeeds = 1000 / kShortenedBy;
  std::vector<std::string> set = overrides("real_time");
  set.push_back("time.duration_s=0.5");
  const Scenario scenario = shipped_scenario("two_storey_one_site", set);
  std::map<StopReason, int> endings;
  std::size_t bridges = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds && !testing::Test::HasFailure(); ++seed) {
    const SimulationSettings settings = drawn_settings(seed);
    const KeptSimulation kept = keep_simulation(scenario, settings);
    ++endings[kept.result.coordinator.reason];
    bridges += bridged(kept);
    const std::string told = "seed " + std::to_string(seed) + "\n" + kept.log();
    // Every step once and in order, and each with what stood for its forces.
    const std::vector<double> steps = kept.table("coordinator", "steps").column_values("step");
    for (std::size_t i = 0; i < steps.size(); ++i) ASSERT_EQ(steps[i], static_cast<double>(i)) << told;
    const KeptRows& exchanges = kept.table("coordinator", "exchanges");
    const std::vector<double> substructure = exchanges.column_values("substructure");
    const std::vector<double> all_flags = exchanges.column_values("flags");
    std::array<int, 2> in_a_row{};
    std::size_t without_answer = 0;
    for (std::size_t i = 0; i < exchanges.size(); ++i) {
      const auto flags = static_cast<MeasurementFlags>(static_cast<std::uint32_t>(all_flags[i]));
      const bool is_bridged = any(flags & MeasurementFlags::bridged);
      without_answer += is_bridged ? 1U : 0U;
      int& misses = in_a_row.at(static_cast<std::size_t>(substructure[i]));
      misses = is_bridged || any(flags & MeasurementFlags::missed) ? misses + 1 : 0;
      ASSERT_LE(misses, kMostInARow + 1) << told;
      if (misses > kMostInARow) {
        ASSERT_EQ(kept.result.coordinator.reason, StopReason::deadlines_missed) << told;
      }
    }
    ASSERT_EQ(without_answer, bridged(kept)) << told;
    // A test ends as planned or says what it missed.
    const StopReason reason = kept.result.coordinator.reason;
    ASSERT_TRUE(reason == StopReason::completed || reason == StopReason::deadlines_missed) << told;
    if (reason == StopReason::completed) {
      ASSERT_EQ(kept.result.coordinator.completed_steps, scenario.time.last_step + 1) << told;
    }
    for (const SimulatedOutcome& outcome : kept.result.participants) ASSERT_TRUE(outcome.is_done) << told;
    // The same seed gives the same bits and bridges.
    if (seed % 20 != 0) continue;
    ASSERT_EQ(keep_simulation(scenario, settings).digest(), kept.digest()) << told;
  }
  RecordProperty("completed", endings[StopReason::completed]);
  RecordProperty("deadlines_missed", endings[StopReason::deadlines_missed]);
  RecordProperty("bridges", static_cast<int>(bridges));
  // The faults drawn reach the test, and do not end every one.
  EXPECT_GE(endings[StopReason::completed], static_cast<int>(kSeeds / 5));
  EXPECT_GE(endings[StopReason::deadlines_missed], static_cast<int>(kSeeds / 20));
  EXPECT_GE(bridges, kSeeds);
}

}  // namespace
}  // namespace hybridtest
