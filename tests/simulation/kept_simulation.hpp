#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/simulation.hpp"
#include "tests/support/kept_rows.hpp"

namespace hybridtest {

/// Everything a simulation said and recorded.
struct KeptSimulation {
  SimulationResult result;
  std::map<std::string, std::map<std::string, KeptRows>> tables;  // by participant, by table
  std::vector<Event> events;

  [[nodiscard]] const KeptRows& table(const std::string& participant, const std::string& name) const;
  [[nodiscard]] KeptRows& table(const std::string& participant, const std::string& name);
  [[nodiscard]] const SimulatedOutcome& outcome(std::string_view participant) const;
  /// Events with this code; an empty source or subject stands for any.
  [[nodiscard]] std::size_t count(EventCode code, std::string_view source = {}, std::string_view subject = {}) const;
  /// FNV-1a over every bit of every row and event, in order.
  [[nodiscard]] std::uint64_t digest() const;
  /// Events, one a line, for the message of a failed test.
  [[nodiscard]] std::string log() const;
};

/// A scenario that ships, with overrides.
[[nodiscard]] Scenario shipped_scenario(std::string_view name, const std::vector<std::string>& overrides);

/// @param progress   as SimulationObserver::progress.
[[nodiscard]] KeptSimulation keep_simulation(
    const Scenario& scenario, const SimulationSettings& settings,
    const std::function<bool(const CoordinatorReport&)>& progress = [](const CoordinatorReport&) { return false; });

}  // namespace hybridtest
