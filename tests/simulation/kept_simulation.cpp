#include "tests/simulation/kept_simulation.hpp"

#include <algorithm>
#include <bit>
#include <filesystem>

#include "core/event_text.hpp"

namespace hybridtest {
namespace {

class Fnv1a {
 public:
  void add(std::uint64_t value) noexcept {
    for (unsigned byte = 0; byte < 8; ++byte) {
      hash_ = (hash_ ^ ((value >> (8U * byte)) & 0xffU)) * 0x100000001b3ULL;
    }
  }
  void add(double value) noexcept { add(std::bit_cast<std::uint64_t>(value)); }
  void add(std::string_view text) noexcept {
    add(static_cast<std::uint64_t>(text.size()));
    for (const char letter : text) add(static_cast<std::uint64_t>(static_cast<unsigned char>(letter)));
  }
  [[nodiscard]] std::uint64_t value() const noexcept { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

}  // namespace

const KeptRows& KeptSimulation::table(const std::string& participant, const std::string& name) const {
  return tables.at(participant).at(name);
}

KeptRows& KeptSimulation::table(const std::string& participant, const std::string& name) {
  return tables.at(participant).at(name);
}

const SimulatedOutcome& KeptSimulation::outcome(std::string_view participant) const {
  return *std::ranges::find(result.participants, participant, &SimulatedOutcome::participant);
}

std::size_t KeptSimulation::count(EventCode code, std::string_view source, std::string_view subject) const {
  return static_cast<std::size_t>(std::ranges::count_if(events, [&](const Event& event) {
    return event.code == code && (source.empty() || event.source.view() == source) &&
           (subject.empty() || event.subject.view() == subject);
  }));
}

std::uint64_t KeptSimulation::digest() const {
  Fnv1a hash;
  for (const auto& [participant, its_tables] : tables) {
    hash.add(std::string_view{participant});
    for (const auto& [name, rows] : its_tables) {
      hash.add(std::string_view{name});
      for (const double value : rows.values()) hash.add(value);
    }
  }
  for (const Event& event : events) {
    hash.add(event.source.view());
    hash.add(event.incarnation);
    hash.add(static_cast<std::uint64_t>(event.code));
    hash.add(static_cast<std::uint64_t>(event.step));
    hash.add(event.model_time_s);
    hash.add(event.subject.view());
    for (const double value : event.values) hash.add(value);
    hash.add(static_cast<std::uint64_t>(event.clock.count()));
  }
  return hash.value();
}

std::string KeptSimulation::log() const {
  std::string text;
  for (const Event& event : events) {
    text += std::to_string(to_seconds(event.clock)) + " " + event.source.text() + ": " + describe(event) + "\n";
  }
  return text;
}

Scenario shipped_scenario(std::string_view name, const std::vector<std::string>& overrides) {
  const std::filesystem::path directory = std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "launch" / "scenarios";
  return read_scenario(directory / (std::string{name} + ".yaml"), overrides);
}

KeptSimulation keep_simulation(const Scenario& scenario, const SimulationSettings& settings,
                               const std::function<bool(const CoordinatorReport&)>& progress) {
  KeptSimulation kept;
  SimulationObserver observer;
  observer.sink = [&](const std::string& participant, const TableLayout& layout) -> RowSink& {
    return kept.tables[participant].try_emplace(layout.name, layout).first->second;
  };
  observer.event = [&](const Event& event) { kept.events.push_back(event); };
  observer.progress = progress;
  kept.result = simulate(scenario, settings, observer);
  return kept;
}

}  // namespace hybridtest
