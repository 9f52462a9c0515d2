#include <gtest/gtest.h>

#include "core/random.hpp"
#include "recording/summary/run_summary.hpp"
#include "tests/simulation/drawn_case.hpp"
#include "tests/simulation/kept_simulation.hpp"
#include "tests/simulation/recorded_simulation.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

/// Runs recorded through rings that are sometimes too small for the rows between two drains: the verdict reports every
/// dropped row.
namespace hybridtest {
namespace {

TEST(Recording, DroppedRecordFailsTheRun) {
  int whole = 0;
  int with_holes = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    DrawnCase drawn = draw_case(seed, CouplingMode::lockstep);
    // The file of a killed process is invalid for that reason alone.
    drawn.settings.kills.clear();
    SCOPED_TRACE(drawn.command());
    const Scenario scenario = shipped_scenario(drawn.scenario, drawn.overrides);
    const TemporaryDirectory directory;
    Random random{seed, 2};
    const std::size_t ring_rows = std::size_t{1} << (8U + random.below(7));
    RecordedSimulation simulation{scenario, directory.path(), ring_rows};
    const StopReason reason = simulation.run(drawn.settings);
    const RunSummary summary = summarise(directory.path());
    EXPECT_EQ(summary.stop_reason, reason);
    EXPECT_EQ(summary.data_valid, simulation.dropped() == 0) << simulation.dropped() << " of rings of " << ring_rows;
    if (simulation.dropped() > 0) {
      ++with_holes;
      EXPECT_NE(summary.exit_code, kExitCompleted);
      std::uint64_t told = 0;
      for (const ParticipantFileSummary& file : summary.participants) told += file.dropped_rows;
      EXPECT_EQ(told, simulation.dropped());
    } else {
      ++whole;
      EXPECT_EQ(summary.exit_code, exit_code_for(reason));
    }
  }
  EXPECT_GE(whole, 5);
  EXPECT_GE(with_holes, 5);
}

}  // namespace
}  // namespace hybridtest
