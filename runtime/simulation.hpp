#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/messages.hpp"
#include "core/records.hpp"
#include "scenario/scenario.hpp"
#include "transport/simulated/simulated_network.hpp"

namespace hybridtest {

/// A participant that dies without a word.
struct SimulatedKill {
  std::string participant;
  Duration at{};  // simulated time
};

struct SimulationSettings {
  std::uint64_t seed = 0;
  simulated::NetworkConditions network;
  std::vector<SimulatedKill> kills;
  /// Clocks run fast or slow by up to so much, drawn by the seed.
  double clock_drift_ppm_max = 50.0;
  /// Nothing a test needs takes this long; a simulation that does is ended and reported.
  Duration time_limit = std::chrono::hours{24};
};

/// Where the simulation's records and events go, and who is told of progress.
struct SimulationObserver {
  std::function<RowSink&(const std::string& participant, const TableLayout& table)> sink;
  std::function<void(const Event& event)> event = [](const Event&) {};
  /// Called now and then with the coordinator's report; true asks for a safe stop.
  std::function<bool(const CoordinatorReport& report)> progress = [](const CoordinatorReport&) { return false; };
};

struct SimulatedOutcome {
  std::string participant;
  bool was_killed = false;
  bool is_done = false;
  StopReason reason = StopReason::none;
  FaultFlags faults = FaultFlags::none;
};

struct SimulationResult {
  CoordinatorReport coordinator;
  std::vector<SimulatedOutcome> participants;  // coordinator first
  simulated::NetworkCounters network;
  Duration simulated_time{};
};

/// Runs every participant of the scenario in this thread under simulated time and a simulated
/// network. The same scenario and settings give the same bytes in every record.
/// @throws ConfigError for a rig outside this process.
[[nodiscard]] SimulationResult simulate(const Scenario& scenario, const SimulationSettings& settings,
                                        const SimulationObserver& observer);

}  // namespace hybridtest
