#include "diagnosis/runs/rerun.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "core/config/section.hpp"
#include "core/config_error.hpp"
#include "diagnosis/runs/run_records.hpp"
#include "diagnosis/test_response.hpp"
#include "recording/error.hpp"
#include "runtime/participant.hpp"
#include "runtime/simulation.hpp"

namespace hybridtest {
namespace {

/// The coordinator's table `steps`, kept in memory.
class StepsTable final : public RowSink {
 public:
  explicit StepsTable(TableLayout layout) : layout_{std::move(layout)} {}

  void append(std::span<const double> row) noexcept override { values_.insert(values_.end(), row.begin(), row.end()); }
  [[nodiscard]] std::vector<double> column(const std::string& name) const {
    std::vector<double> values;
    const auto at = std::ranges::find(layout_.columns, name, &Column::name) - layout_.columns.begin();
    for (auto i = static_cast<std::size_t>(at); i < values_.size(); i += layout_.columns.size()) {
      values.push_back(values_[i]);
    }
    return values;
  }

 private:
  TableLayout layout_;
  std::vector<double> values_;
};

struct SimulatedTest {
  TestResponse response;
  StopReason reason = StopReason::none;
};

SimulatedTest simulated_test(const Scenario& scenario, const PartProgress& progress) {
  StepsTable steps{CoordinatorParticipant::tables(scenario).front()};
  NoRecord nothing;
  SimulationObserver observer;
  observer.sink = [&](const std::string& participant, const TableLayout& table) -> RowSink& {
    if (participant == kCoordinatorId && table.name == "steps") return steps;
    return nothing;
  };
  observer.progress = [&](const CoordinatorReport& report) {
    const auto steps_in_all = static_cast<std::size_t>(scenario.time.last_step + 1);
    progress.report("steps of the whole test, simulated again",
                    std::min(steps_in_all, static_cast<std::size_t>(report.completed_steps)), steps_in_all);
    return false;
  };
  // The network of `hybridtest simulate`: a lockstep test does not depend on it.
  SimulationSettings settings;
  settings.network.latency = std::chrono::microseconds{tuning::kRerunLatency_us};
  const SimulationResult result = simulate(scenario, settings, observer);
  return {response_of_steps(scenario, [&](const std::string& name) { return steps.column(name); }),
          result.coordinator.reason};
}

/// The list `effects` of the scenario with the causes added.
std::string longer_effects(const std::filesystem::path& file, std::span<const EffectSetting> causes) {
  config::Document document = config::Document::load(file);
  config::Section root = document.root();
  std::string list;
  for (const ListedEffect& own : read_effects(root, {EffectInterface::numerical_substructure}, 0)) {
    list += written_effect(own);
  }
  for (const EffectSetting& cause : causes) list += written_effect({cause, {}});
  return list;
}

/// The scenario with compensator and rig of the site replaced by those of the model, effects of the structure added,
/// and the laboratory rigs of other sites replaced by their models. The compensator is the model's because causes
/// found beside it correct it.
Scenario scenario_with(const std::filesystem::path& file, const std::string& site, const SiteModelText& model,
                       std::span<const EffectSetting> structure_causes) {
  const std::string place = "substructures[" + site + "].";
  std::vector<std::string> overrides{
      place + "compensator=" + (model.compensators.empty() ? "{type: none}" : "\n" + model.compensators),
      place + "rig=" + model.rig};
  if (!structure_causes.empty()) overrides.push_back("effects=\n" + longer_effects(file, structure_causes));
  for (const SubstructureScenario& other : read_scenario(file, {}).substructures) {
    if (other.id == site || !other.site.rig_is_elsewhere) continue;
    if (!other.site.has_model) {
      throw ConfigError{"the rig of " + other.id + " is in a laboratory and has no model; add `model: FILE` beside it"};
    }
    overrides.push_back("substructures[" + other.id + "].rig=" + read_site_model(file, other.id).rig);
  }
  Scenario scenario = read_scenario(file, overrides);
  for (SubstructureScenario& substructure : scenario.substructures) {
    // A model has no sensors that could be dead. Without noise, the force of one that yields stands still.
    substructure.site.loop.limits.stuck_samples.reset();
    substructure.site.loop.limits.tracking_error_m.reset();
  }
  return scenario;
}

std::string early_end(std::string_view which, const SimulatedTest& test, Eigen::Index recorded_steps) {
  return fmt::format(
      "With the model {}, the simulated test stops after {} of {} steps ({}). The responses are compared up to that "
      "step.",
      which, test.response.steps(), recorded_steps, name(test.reason));
}

/// Adds a note if the simulated test stops earlier than the recorded test.
void note_early_end(std::string_view which, const SimulatedTest& test, const TestResponse& recorded,
                    std::vector<std::string>& notes) {
  if (test.response.steps() < recorded.steps()) notes.push_back(early_end(which, test, recorded.steps()));
}

report::ResponseShrink shrink_of(const TestResponse& recorded, const TestResponse& model,
                                 const TestResponse& augmented) {
  const ResponseError before = response_error(recorded, model);
  const ResponseError after = response_error(recorded, augmented);
  return {.nrmse_before = before.nrmse,
          .nrmse_after = after.nrmse,
          .peak_error_before = before.peak_error,
          .peak_error_after = after.peak_error,
          .energy_error_before = before.energy_error,
          .energy_error_after = after.energy_error};
}

}  // namespace

void add_response(SiteDiagnosis& diagnosis, const SiteModelFile& model, const std::filesystem::path& run,
                  std::string_view site, const std::filesystem::path& scenario, const PartProgress& progress) {
  report::DiagnosisReport& report = diagnosis.diagnosis.report;
  const std::vector<ListedEffect> causes = diagnosis.listed_causes(model);
  if (causes.empty() && diagnosis.structure_causes.empty()) {
    report.why_no_response = "nothing was added to the model";
    return;
  }
  try {
    const std::string id = site_of_run(run, site);
    const Scenario before = scenario_with(scenario, id, model, {});
    const Scenario after = scenario_with(scenario, id, model.with_effects(causes), diagnosis.structure_causes);
    const TestResponse recorded = recorded_response(run, before);
    const SimulatedTest as_given = simulated_test(before, progress.round(0, 2));
    const SimulatedTest augmented = simulated_test(after, progress.round(1, 2));
    note_early_end("as given", as_given, recorded, report.notes);
    note_early_end("with the causes added", augmented, recorded, report.notes);
    report.response_shrink = shrink_of(recorded, as_given.response, augmented.response);
    report.response_shrink->recording = run.string();
    report.why_no_response.clear();
  } catch (const ConfigError& error) {
    report.why_no_response = fmt::format("the test cannot be simulated: {}", error.what());
  } catch (const RecordingError& error) {
    report.why_no_response = fmt::format("the recorded response cannot be read: {}", error.what());
  }
}

}  // namespace hybridtest
