#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numeric>
#include <string>
#include <vector>

#include "tests/simulation/drawn_case.hpp"
#include "tests/simulation/invariants.hpp"
#include "tests/simulation/kept_simulation.hpp"

/// Links between cities that lose packets: the result, and the time that a step takes.
namespace hybridtest {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr double kLossyStep_s = 0.02;
constexpr int kLossySteps = 400;

Scenario storeys_apart(CouplingMode mode) {
  return shipped_scenario(
      "two_storey_one_site",
      {kPulse, std::string{"time.mode="} + std::string{name(mode)}, "time.step_s=0.02",
       "time.duration_s=" + std::to_string(kLossySteps * kLossyStep_s), "timeouts={link_s: 60}",
       "substructures[storey_1].limits.command_age_s=10.0", "substructures[storey_1].compensator={type: none}",
       "substructures[storey_1].trajectory={type: ramp_and_hold}",
       "substructures[storey_1].rig={type: simulated, transfer_system: {type: ideal}, specimen: {type: bilinear, "
       "stiffness_n_per_m: 4.0e6, yield_force_n: 40.0e3, hardening_ratio: 0.05}}"});
}

struct StepRatios {
  double mean = 0.0;
  double commands_a_step = 0.0;
};

/// The time of a step over one round trip and, in paced mode, the time in which the site imposes it. The first steps
/// are left out, in which the coordinator learns how long an answer takes.
StepRatios step_ratios(const KeptSimulation& run, milliseconds round_trip, CouplingMode mode) {
  constexpr std::size_t kFirst = 10;
  const std::vector<double> wall_s = run.table("coordinator", "steps").column_values("wall_time_s");
  const std::vector<double> attempts = run.table("coordinator", "exchanges").column_values("attempts");
  if (wall_s.size() <= kFirst) return {};
  const double expected_s = to_seconds(round_trip) + (mode == CouplingMode::paced ? kLossyStep_s : 0.0);
  return {.mean = (wall_s.back() - wall_s[kFirst]) / static_cast<double>(wall_s.size() - 1 - kFirst) / expected_s,
          .commands_a_step = std::reduce(attempts.begin(), attempts.end()) / static_cast<double>(attempts.size())};
}

/// The most that repeats at the end of each round trip take: both substructures answer in the first, or not.
double of_repeats_alone(double loss) {
  const double exchange = (1.0 - loss) * (1.0 - loss);
  double mean = 0.0;  // of the larger one of two geometric numbers
  for (int round = 0; round < 200; ++round) mean += 1.0 - std::pow(1.0 - std::pow(1.0 - exchange, round), 2);
  return mean;
}

class LossyLinks : public testing::TestWithParam<CouplingMode> {};

TEST_P(LossyLinks, StepTakesAtMostElevenTenthsOfARoundTrip) {
  const Scenario scenario = storeys_apart(GetParam());
  const KeptSimulation reference = keep_simulation(storeys_apart(CouplingMode::lockstep), SimulationSettings{});
  for (const int round_trip_ms : {10, 50, 150}) {
    for (const double loss : {0.0, 0.01, 0.05, 0.2}) {
      SCOPED_TRACE(std::to_string(round_trip_ms) + " ms, " + std::to_string(loss));
      SimulationSettings settings;
      settings.network.latency = microseconds{500 * round_trip_ms};
      settings.network.loss = loss;
      const KeptSimulation run = keep_simulation(scenario, settings);
      ASSERT_EQ(run.result.coordinator.reason, StopReason::completed) << run.log();
      EXPECT_EQ(steps_violated(run, scenario), Violations{});
      EXPECT_EQ(history_violated(run, reference), Violations{});
      const StepRatios ratio = step_ratios(run, milliseconds{round_trip_ms}, GetParam());
      std::cout << name(GetParam()) << ", " << round_trip_ms << " ms, " << 100.0 * loss << " % lost: " << ratio.mean
                << " in the mean, " << ratio.commands_a_step << " commands a step; repeats alone "
                << of_repeats_alone(loss) << '\n';
      EXPECT_LE(ratio.mean, 1.1);
      EXPECT_TRUE(loss > 0.0 || ratio.commands_a_step == 1.0) << ratio.commands_a_step;
    }
  }
}

TEST_P(LossyLinks, CopiesAmongDoubledAndLateOnesMoveNothingTwice) {
  const Scenario scenario = storeys_apart(GetParam());
  const KeptSimulation reference = keep_simulation(storeys_apart(CouplingMode::lockstep), SimulationSettings{});
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    SimulationSettings settings;
    settings.seed = seed;
    settings.network.latency = milliseconds{25};
    settings.network.jitter = milliseconds{5};
    settings.network.loss = 0.1;
    settings.network.duplication = 0.3;
    settings.network.reordering = 0.3;
    const KeptSimulation run = keep_simulation(scenario, settings);
    ASSERT_EQ(run.result.coordinator.reason, StopReason::completed) << run.log();
    EXPECT_EQ(steps_violated(run, scenario), Violations{});
    EXPECT_EQ(limits_violated(run, scenario), Violations{});
    EXPECT_EQ(history_violated(run, reference), Violations{});
    EXPECT_GT(step_ratios(run, milliseconds{50}, GetParam()).commands_a_step, 1.5);
    EXPECT_GT(run.result.network.duplicated, 0U);
    EXPECT_GT(run.result.network.reordered, 0U);
  }
}

INSTANTIATE_TEST_SUITE_P(Modes, LossyLinks, testing::Values(CouplingMode::lockstep, CouplingMode::paced),
                         [](const auto& mode) { return std::string{name(mode.param)}; });

}  // namespace
}  // namespace hybridtest
