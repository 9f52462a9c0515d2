#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>

#include "core/random.hpp"
#include "launch/participant.hpp"
#include "launch/run_directory.hpp"
#include "recording/recorder.hpp"
#include "recording/summary/run_summary.hpp"
#include "tests/simulation/drawn_case.hpp"
#include "tests/simulation/kept_simulation.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

/// Runs recorded into files through rings that are sometimes too small for what comes between
/// two drains: whatever was dropped, the verdict knows.
namespace hybridtest {
namespace {

class RecordedSimulation {
 public:
  RecordedSimulation(const Scenario& scenario, const std::filesystem::path& directory, std::size_t ring_rows)
      : scenario_{scenario}, directory_{directory}, ring_rows_{ring_rows} {
    make(std::string{kCoordinatorId}, Role::coordinator, CoordinatorParticipant::tables(scenario));
    for (const SubstructureScenario& substructure : scenario.substructures) {
      make(substructure.id, substructure.role, substructure_tables(substructure));
    }
  }

  StopReason run(const SimulationSettings& settings) {
    SimulationObserver observer;
    observer.sink = [&](const std::string& participant, const TableLayout& table) -> RowSink& {
      return recorders_.at(participant)->sink(table.name);
    };
    observer.event = [&](const Event& event) { recorders_.at(event.source.text())->events().send(event); };
    observer.progress = [&](const CoordinatorReport&) {
      for (auto& [id, recorder] : recorders_) recorder->drain();
      return false;
    };
    const SimulationResult result = simulate(scenario_, settings, observer);
    recorders_.at(std::string{kCoordinatorId})
        ->sink("test")
        .append(test_row(scenario_, result.coordinator, exit_code_for(result.coordinator.reason)));
    for (auto& [id, recorder] : recorders_) {
      recorder->close();
      dropped_ += recorder->dropped();
    }
    return result.coordinator.reason;
  }

  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  void make(const std::string& id, Role role, std::vector<TableLayout> tables) {
    if (role == Role::coordinator) tables.push_back(test_layout());
    std::vector<RecordedTable> recorded;
    for (const TableLayout& table : tables) recorded.push_back({table, ring_rows_});
    recorders_[id] =
        std::make_unique<Recorder>(run_file(directory_, id), run_file_header(scenario_, id, role, 1), recorded);
  }

  const Scenario& scenario_;
  std::filesystem::path directory_;
  std::size_t ring_rows_;
  std::map<std::string, std::unique_ptr<Recorder>> recorders_;
  std::uint64_t dropped_ = 0;
};

TEST(Recording, NoRunPassesWithADroppedRecord) {
  int whole = 0;
  int with_holes = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    DrawnCase drawn = draw_case(seed, CouplingMode::lockstep);
    // A file that a killed process left is invalid for that alone.
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
