#include <gtest/gtest.h>

#include <map>

#include "tests/simulation/drawn_case.hpp"
#include "tests/simulation/invariants.hpp"
#include "tests/simulation/kept_simulation.hpp"
#include "tests/support/sanitizers.hpp"

/// Whole-system runs with faults drawn by a seed. A failure prints the command that repeats it.
namespace hybridtest {
namespace {

constexpr std::uint64_t kSeeds = 200 / kShortenedBy;

class Seeds : public testing::TestWithParam<CouplingMode> {
 protected:
  void run(std::uint64_t seed) {
    const DrawnCase drawn = draw_case(seed, GetParam());
    const Scenario scenario = shipped_scenario(drawn.scenario, drawn.overrides);
    SimulationSettings faultless;
    faultless.seed = 1;
    const KeptSimulation reference = keep_simulation(scenario, faultless);
    const KeptSimulation kept = keep_simulation(scenario, drawn.settings);
    ++endings_[kept.result.coordinator.reason];
    network_.lost += kept.result.network.lost;
    network_.duplicated += kept.result.network.duplicated;
    network_.reordered += kept.result.network.reordered;

    expect_none(steps_violated(kept, scenario), kept, drawn);
    expect_none(limits_violated(kept, scenario), kept, drawn);
    expect_none(energy_violated(kept, scenario), kept, drawn);
    expect_none(ending_violated(kept, reference, scenario, drawn), kept, drawn);
    if (GetParam() == CouplingMode::lockstep) expect_none(history_violated(kept, reference), kept, drawn);
  }

  static void expect_none(const Violations& violations, const KeptSimulation& kept, const DrawnCase& drawn) {
    for (const std::string& violation : violations) {
      ADD_FAILURE() << violation << "\n" << kept.log() << "repeat it with\n  " << drawn.command();
    }
  }

  std::map<StopReason, int> endings_;
  simulated::NetworkCounters network_;
};

TEST_P(Seeds, KeepTheInvariants) {
  for (std::uint64_t seed = 1; seed <= kSeeds && !HasFailure(); ++seed) run(seed);
  for (const auto& [reason, count] : endings_) RecordProperty(std::string{name(reason)}, count);
  // The faults drawn reach the nodes, and do not end every test.
  EXPECT_GE(endings_[StopReason::completed], 80 / kShortenedBy);
  EXPECT_GE(endings_[StopReason::participant_lost], 10 / kShortenedBy);
  EXPECT_GE(endings_[StopReason::interlock], 10 / kShortenedBy);
  EXPECT_GE(network_.lost, 1000U / kShortenedBy);
  EXPECT_GE(network_.duplicated, 1000U / kShortenedBy);
  EXPECT_GE(network_.reordered, 1000U / kShortenedBy);
}

INSTANTIATE_TEST_SUITE_P(Modes, Seeds, testing::Values(CouplingMode::lockstep, CouplingMode::paced),
                         [](const auto& mode) { return mode.param == CouplingMode::lockstep ? "lockstep" : "paced"; });

}  // namespace
}  // namespace hybridtest
