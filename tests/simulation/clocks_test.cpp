#include <gtest/gtest.h>

#include <cmath>

#include "recording/summary/clock_relation.hpp"
#include "tests/simulation/kept_simulation.hpp"

/// Clocks of several hosts, under simulated time where their truth is known.
namespace hybridtest {
namespace {

std::vector<ClockBounds> bounds_of(const KeptSimulation& kept, double substructure) {
  const KeptRows& rows = kept.table("coordinator", "clocks");
  std::vector<ClockBounds> bounds;
  const auto column = [&](const char* name) { return rows.column_values(name); };
  const std::vector<double> who = column("substructure");
  for (std::size_t i = 0; i < who.size(); ++i) {
    if (who[i] != substructure) continue;
    bounds.push_back({column("there_at_s")[i], column("least_there_s")[i], column("back_at_s")[i],
                      column("least_back_s")[i], column("exchanges")[i], column("mean_there_s")[i],
                      column("mean_back_s")[i]});
  }
  return bounds;
}

/// Clock of the participant less the coordinator's, when the latter shows `coordinator_s`.
double true_offset_s(const SimulatedOutcome& participant, const SimulatedOutcome& coordinator, double coordinator_s) {
  const double simulated_s = to_seconds(coordinator.clock_start) + coordinator_s / (1.0 + coordinator.clock_drift);
  return (simulated_s - to_seconds(participant.clock_start)) * (1.0 + participant.clock_drift) - coordinator_s;
}

class Clocks : public testing::TestWithParam<std::string> {};

TEST_P(Clocks, OffsetAndDriftAreWithinTheirUncertainty) {
  constexpr Duration kLatency = std::chrono::milliseconds{10};
  std::vector<std::string> set{"time.mode=" + GetParam(), "time.duration_s=10"};
  if (GetParam() != "lockstep") set.emplace_back("time.step_s=0.05");
  if (GetParam() == "real_time") set.emplace_back("bridging={start_anyway: true}");
  double furthest = 0.0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SimulationSettings settings{.seed = seed};
    settings.network.latency = kLatency;
    settings.network.jitter = std::chrono::milliseconds{5};
    settings.network.loss = 0.02;
    settings.clock_drift_ppm_max = 100.0;
    const KeptSimulation kept = keep_simulation(shipped_scenario("two_storey_one_site", set), settings);
    for (const double index : {0.0, 1.0}) {
      const auto relation = relate_clocks(bounds_of(kept, index));
      ASSERT_TRUE(relation) << kept.log();
      const SimulatedOutcome& coordinator = kept.outcome("coordinator");
      const SimulatedOutcome& participant = kept.outcome(index == 0.0 ? "storey_1" : "storey_2");
      const double truth_s = true_offset_s(participant, coordinator, relation->at_s);
      EXPECT_LE(std::abs(relation->offset_s - truth_s), relation->offset_uncertainty_s) << seed;
      const double drift = (1.0 + participant.clock_drift) / (1.0 + coordinator.clock_drift) - 1.0;
      EXPECT_LE(std::abs(relation->drift - drift), relation->drift_uncertainty) << seed;
      // The least round trip has no jitter to speak of: the middle is nearer than the jitter.
      EXPECT_LT(relation->offset_uncertainty_s, 0.013);
      furthest = std::max(furthest, std::abs(relation->offset_s - truth_s));
    }
  }
  EXPECT_LT(furthest, 0.003) << "the least latencies of both ways are nearly alike";
}

INSTANTIATE_TEST_SUITE_P(InEachMode, Clocks, testing::Values("lockstep", "paced", "real_time"),
                         [](const auto& mode) { return mode.param; });

}  // namespace
}  // namespace hybridtest
