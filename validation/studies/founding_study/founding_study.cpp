#include "validation/studies/founding_study/founding_study.hpp"

#include <map>
#include <utility>

#include "core/event_text.hpp"
#include "runtime/participant.hpp"
#include "runtime/simulation.hpp"
#include "validation/studies/founding_study/kept_table.hpp"
#include "validation/studies/parallel_runs.hpp"

namespace hybridtest::founding {
namespace {

/// Seed of the simulated network and clocks; the sensors have their seed in the scenario. In lockstep, over a
/// network without loss, no result depends on it.
constexpr std::uint64_t kSeed = 1;

using Tables = std::map<std::string, KeptTable, std::less<>>;

MethodRun run_of(const Tables& tables, const Scenario& scenario) {
  MethodRun run;
  const KeptTable& steps = tables.at("steps");
  const KeptTable& control = tables.at("control");
  run.time_s = steps.column("model_time_s");
  run.period_time_s = control.column("model_time_s");
  run.energy_error_j = control.column("energy_error_j");
  for (std::size_t floor = 0; floor < kFloors; ++floor) {
    run.displacement_m[floor] = steps.column("displacement_" + scenario.dofs.at(floor) + "_m");
  }
  for (std::size_t actuator = 0; actuator < kActuators; ++actuator) {
    run.force_n[actuator] = control.column("compensated_force_n_" + std::to_string(actuator + 1));
  }
  return run;
}

}  // namespace

MethodRun run_method(const std::filesystem::path& scenario_file) {
  const Scenario scenario = read_scenario(scenario_file, {});
  SimulationSettings settings;
  settings.seed = kSeed;
  Tables tables;  // the coordinator's steps, the site's control periods
  std::string interlock;
  NoRecord nowhere;
  SimulationObserver observer;
  observer.sink = [&](const std::string& participant, const TableLayout& layout) -> RowSink& {
    const bool is_wanted = layout.name == (participant == kCoordinatorId ? "steps" : "control");
    return is_wanted ? static_cast<RowSink&>(tables.try_emplace(layout.name, layout).first->second) : nowhere;
  };
  observer.event = [&](const Event& event) {
    if (event.code == EventCode::interlock_tripped && interlock.empty()) interlock = describe(event);
  };
  const SimulationResult result = simulate(scenario, settings, observer);
  MethodRun run = run_of(tables, scenario);
  run.name = scenario_file.stem().string();
  run.reason = result.coordinator.reason;
  run.interlock = std::move(interlock);
  return run;
}

std::vector<MethodRun> run_founding_study(const std::filesystem::path& scenarios, unsigned threads,
                                          StudyProgress& progress) {
  std::vector<MethodRun> runs(kMethods.size());
  run_in_parallel(runs.size(), threads, [&](std::size_t i) {
    runs[i] = run_method(scenarios / (std::string{kMethods[i].name} + ".yaml"));
    progress.completed(kMethods[i].name);
  });
  return runs;
}

}  // namespace hybridtest::founding
