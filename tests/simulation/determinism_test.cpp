#include <gtest/gtest.h>

#include "tests/simulation/drawn_case.hpp"
#include "tests/simulation/invariants.hpp"
#include "tests/simulation/kept_simulation.hpp"

namespace hybridtest {
namespace {

class Determinism : public testing::TestWithParam<CouplingMode> {};

TEST_P(Determinism, SameSeedGivesSameBytes) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const DrawnCase drawn = draw_case(seed, GetParam());
    SCOPED_TRACE(drawn.command());
    // Read again each time, so that no state is shared.
    const auto digest = [&] {
      return keep_simulation(shipped_scenario(drawn.scenario, drawn.overrides), drawn.settings).digest();
    };
    EXPECT_EQ(digest(), digest());
  }
}

INSTANTIATE_TEST_SUITE_P(Modes, Determinism, testing::Values(CouplingMode::lockstep, CouplingMode::paced),
                         [](const auto& mode) { return mode.param == CouplingMode::lockstep ? "lockstep" : "paced"; });

class Lockstep : public testing::Test {
 protected:
  Scenario scenario_ = shipped_scenario("two_storey_two_sites", {kPulse, "time.duration_s=0.5"});
  KeptSimulation reference_ = keep_simulation(scenario_, SimulationSettings{});
};

TEST_F(Lockstep, NetworkSeedDoesNotChangeTheHistory) {
  SimulationSettings settings;
  settings.seed = 2;
  settings.network.jitter = std::chrono::milliseconds{1};
  const KeptSimulation other = keep_simulation(scenario_, settings);
  EXPECT_NE(other.digest(), reference_.digest()) << "the digest must see the network";
  EXPECT_EQ(history_violated(other, reference_), Violations{});
}

TEST_F(Lockstep, ClockDriftDoesNotChangeTheHistory) {
  for (const double drift_ppm : {0.0, 500.0, 20000.0}) {
    SimulationSettings settings;
    settings.seed = 3;
    settings.clock_drift_ppm_max = drift_ppm;
    const KeptSimulation other = keep_simulation(scenario_, settings);
    EXPECT_EQ(other.result.coordinator.reason, StopReason::completed);
    EXPECT_EQ(history_violated(other, reference_), Violations{}) << drift_ppm;
  }
}

TEST_F(Lockstep, NoiseSeedChangesTheHistory) {
  const Scenario other =
      shipped_scenario("two_storey_two_sites",
                       {kPulse, "time.duration_s=0.5", "substructures[first_storey_columns].rig.sensors.seed=8"});
  EXPECT_FALSE(history_violated(keep_simulation(other, SimulationSettings{}), reference_).empty());
}

}  // namespace
}  // namespace hybridtest
