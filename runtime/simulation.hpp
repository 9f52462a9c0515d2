#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/messages.hpp"
#include "core/presence.hpp"
#include "core/records.hpp"
#include "scenario/scenario.hpp"
#include "transport/simulated/simulated_network.hpp"

namespace hybridtest {

/// A participant that ends without a message, as a process that is killed.
struct SimulatedKill {
  std::string participant;
  Duration at{};  // simulated time
};

/// A time in which the machine of a participant does nothing, as when its process is stopped. Messages wait.
struct SimulatedPause {
  std::string participant;
  Duration begin{};  // simulated time
  Duration end{};
};

struct SimulationSettings {
  std::uint64_t seed = 0;
  simulated::NetworkConditions network{};
  std::vector<SimulatedKill> kills{};
  std::vector<SimulatedPause> pauses{};
  /// Largest drift of a clock; the drift is drawn from the seed.
  double clock_drift_ppm_max = 50.0;
  /// A simulation that takes longer is ended and reported; no test needs this time.
  Duration time_limit = std::chrono::hours{24};
};

/// Receives the records, events and progress of a simulation.
struct SimulationObserver {
  std::function<RowSink&(const std::string& participant, const TableLayout& table)> sink;
  std::function<void(const Event& event)> event = [](const Event&) {};
  /// Called at intervals for each participant; `now` is its clock. May report faults of its recording.
  std::function<void(const std::string& participant, Presence& presence, Instant now)> housekeeping =
      [](const std::string&, Presence&, Instant) {};
  /// Called at intervals, after the housekeeping, with the report of the coordinator; true requests a safe stop.
  std::function<bool(const CoordinatorReport& report)> progress = [](const CoordinatorReport&) { return false; };
};

struct SimulatedOutcome {
  std::string participant;
  bool was_killed = false;
  bool is_done = false;
  StopReason reason = StopReason::none;
  FaultFlags faults = FaultFlags::none;
  Duration clock_start{};    // simulated time when its clock stood at zero
  double clock_drift = 0.0;  // [s/s] of its clock against simulated time
};

struct SimulationResult {
  CoordinatorReport coordinator;
  std::vector<SimulatedOutcome> participants;  // coordinator first
  simulated::NetworkCounters network;
  Duration simulated_time{};
};

/// @throws ConfigError for a rig outside this process.
void require_simulable(const Scenario& scenario);

/// Runs every participant of the scenario in this thread under simulated time and a simulated
/// network. The same scenario and settings give the same bytes in every record.
/// @throws ConfigError as require_simulable().
[[nodiscard]] SimulationResult simulate(const Scenario& scenario, const SimulationSettings& settings,
                                        const SimulationObserver& observer);

}  // namespace hybridtest
