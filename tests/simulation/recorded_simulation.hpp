#pragma once

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <string>

#include "recording/recorder.hpp"
#include "runtime/participant.hpp"
#include "runtime/run_directory.hpp"
#include "runtime/simulation.hpp"

namespace hybridtest {

/// A simulation whose participants record into the files of a run directory.
class RecordedSimulation {
 public:
  /// @param ring_rows   rows that fit between two steps without being dropped.
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
    Recorder& coordinator = *recorders_.at(std::string{kCoordinatorId});
    write_test_tables(scenario_, result.coordinator, exit_code_for(result.coordinator.reason),
                      [&](std::string_view table) -> RowSink& { return coordinator.sink(table); });
    for (auto& [id, recorder] : recorders_) {
      recorder->close();
      dropped_ += recorder->dropped();
    }
    return result.coordinator.reason;
  }

  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  void make(const std::string& id, Role role, std::vector<TableLayout> tables) {
    if (role == Role::coordinator) std::ranges::move(test_tables(), std::back_inserter(tables));
    std::vector<RecordedTable> recorded;
    for (const TableLayout& table : tables) recorded.push_back({table, ring_rows_});
    recorders_[id] =
        std::make_unique<Recorder>(run_file(directory_, id), run_file_header(scenario_, id, role, 1, {}), recorded);
  }

  const Scenario& scenario_;
  std::filesystem::path directory_;
  std::size_t ring_rows_;
  std::map<std::string, std::unique_ptr<Recorder>> recorders_;
  std::uint64_t dropped_ = 0;
};

}  // namespace hybridtest
