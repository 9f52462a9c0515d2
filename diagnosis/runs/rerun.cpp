#include "diagnosis/runs/rerun.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <span>
#include <utility>

#include "core/config/section.hpp"
#include "core/config_error.hpp"
#include "core/random.hpp"
#include "core/text/scalar.hpp"
#include "diagnosis/identification/noise_of_sensors.hpp"
#include "diagnosis/response_shrink.hpp"
#include "diagnosis/runs/run_records.hpp"
#include "diagnosis/test_response.hpp"
#include "diagnosis/verdict/drawn_causes.hpp"
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

/// A test that ends later than the recorded one is compared up to its end.
TestResponse first_steps(TestResponse response, Eigen::Index steps) {
  if (response.steps() <= steps) return response;
  for (Eigen::MatrixXd* signal :
       {&response.displacement_m, &response.velocity_m_per_s, &response.restoring_force_n, &response.applied_force_n}) {
    *signal = Eigen::MatrixXd{signal->leftCols(steps)};
  }
  return response;
}

/// @param steps_most   of the response.
SimulatedTest simulated_test(const Scenario& scenario, Eigen::Index steps_most, const PartProgress& progress) {
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
  TestResponse response = response_of_steps(scenario, [&](const std::string& name) { return steps.column(name); });
  return {first_steps(std::move(response), steps_most), result.coordinator.reason};
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

/// The key `sensors` of a rig.
std::string written_sensors(const SensorNoise& noise) {
  std::string text =
      fmt::format("displacement_noise_m: {}, force_noise_n: {}, seed: {}", written_number(noise.displacement_noise_m),
                  written_number(noise.force_noise_n), noise.seed);
  const auto add_coloured = [&](std::string_view level, double value, std::string_view correlation_time,
                                double time_s) {
    if (!(value > 0.0)) return;
    text += fmt::format(", {}: {}, {}: {}", level, written_number(value), correlation_time, written_number(time_s));
  };
  add_coloured("displacement_coloured_noise_m", noise.displacement_coloured_noise_m, "displacement_correlation_time_s",
               noise.displacement_correlation_time_s);
  add_coloured("force_coloured_noise_n", noise.force_coloured_noise_n, "force_correlation_time_s",
               noise.force_correlation_time_s);
  return "{" + text + "}";
}

/// The scenario with compensator and rig of the site replaced by those of the model, effects of the structure added,
/// and the laboratory rigs of other sites replaced by their models. The compensator is the model's because causes
/// found beside it correct it. Its sensors have this noise and no other: that of the recorded test is in the recording.
Scenario scenario_with(const std::filesystem::path& file, const std::string& site, const SiteModelText& model,
                       std::span<const EffectSetting> structure_causes, const SensorNoise& noise) {
  const std::string place = "substructures[" + site + "].";
  std::vector<std::string> overrides{
      place + "compensator=" + (model.compensators.empty() ? "{type: none}" : "\n" + model.compensators),
      place + "rig=" + model.rig, place + "rig.sensors=" + written_sensors(noise)};
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

/// The test of a run directory, to be simulated with other models of the site.
class RepeatedTest {
 public:
  RepeatedTest(const SiteModelFile& model, const SiteDiagnosis& diagnosis, std::filesystem::path scenario,
               std::string site)
      : model_{model},
        scenario_{std::move(scenario)},
        site_{std::move(site)},
        listed_{diagnosis.listed_causes(model)},
        structure_causes_{diagnosis.structure_causes} {}

  [[nodiscard]] Scenario as_given() const { return scenario_with(scenario_, site_, model_, {}, {}); }

  /// @param deviation   of the parameters of the causes; empty: none.
  [[nodiscard]] Scenario completed(const Eigen::VectorXd& deviation, const SensorNoise& noise) const {
    std::vector<EffectSetting> causes;
    std::ranges::transform(listed_, std::back_inserter(causes), &ListedEffect::setting);
    causes = moved_causes(causes, deviation);
    std::vector<ListedEffect> moved = listed_;
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i].setting = causes[i];
    return scenario_with(scenario_, site_, model_.with_effects(moved), structure_causes_, noise);
  }

  /// With parameters that the model refuses mirrored at those found, or else with those found.
  [[nodiscard]] Scenario possible(const Eigen::VectorXd& deviation, const SensorNoise& noise) const {
    for (const double sign : {1.0, -1.0}) {
      try {
        return completed(sign * deviation, noise);
      } catch (const ConfigError&) {
        continue;
      }
    }
    return completed({}, noise);
  }

 private:
  const SiteModelFile& model_;
  std::filesystem::path scenario_;
  std::string site_;
  std::vector<ListedEffect> listed_;
  std::vector<EffectSetting> structure_causes_;
};

/// The model with the causes, one per degree of freedom.
std::vector<SiteModel> completed_dofs(const SiteModelFile& model, std::span<const ListedEffect> causes) {
  std::vector<SiteModel> completed = model.dofs;
  for (const ListedEffect& cause : causes) {
    for (std::size_t dof = 0; dof < completed.size(); ++dof) {
      if (!cause.dof || std::cmp_equal(*cause.dof, dof)) add_effect(completed[dof], cause.setting);
    }
  }
  return completed;
}

/// Runs the completed test with drawn noise, and with drawn noise and parameters.
PossibleTests possible_tests(const RepeatedTest& test, std::span<const Eigen::MatrixXd> doubts, SensorNoise noise,
                             const TestResponse& completed, const PartProgress& progress) {
  PossibleTests possible;
  Random random{tuning::kNoiseSeed};
  std::size_t round = 0;
  const auto add_to = [&](std::vector<PossibleTest>& tests, const Eigen::VectorXd& deviation) {
    ++noise.seed;
    const SimulatedTest drawn =
        simulated_test(test.possible(deviation, noise), completed.steps(), progress.round(round++, 2 * draws_for_95()));
    tests.push_back(possible_test(drawn.response, completed));
  };
  for (std::size_t i = 0; i < draws_for_95(); ++i) {
    add_to(possible.of_noise, {});
    add_to(possible.of_both, drawn_deviation(doubts, random));
  }
  return possible;
}

}  // namespace

void add_response(SiteDiagnosis& diagnosis, const SiteModelFile& model, const std::filesystem::path& run,
                  std::string_view site, const std::filesystem::path& scenario, const PartProgress& progress) {
  report::DiagnosisReport& report = diagnosis.diagnosis.report;
  if (diagnosis.listed_causes(model).empty() && diagnosis.structure_causes.empty()) {
    report.why_no_response = "nothing was added to the model";
    return;
  }
  try {
    const std::string id = site_of_run(run, site);
    const RepeatedTest test{model, diagnosis, scenario, id};
    const Scenario before = test.as_given();
    const TestResponse recorded = recorded_response(run, before);
    const SensorNoise noise = noise_of_sensors(completed_dofs(model, diagnosis.listed_causes(model)),
                                               read_recording(run, RecordingRole::fit, id));
    const std::size_t rounds = 2 + 2 * draws_for_95();
    const SimulatedTest as_given = simulated_test(before, recorded.steps(), progress.round(0, rounds));
    const SimulatedTest completed = simulated_test(test.completed({}, {}), recorded.steps(), progress.round(1, rounds));
    note_early_end("as given", as_given, recorded, report.notes);
    note_early_end("with the causes added", completed, recorded, report.notes);
    const PossibleTests possible = possible_tests(test, diagnosis.doubts(), noise, completed.response,
                                                  progress.part(2.0 / static_cast<double>(rounds), 1.0));
    report.response_shrink =
        response_shrink(recorded, as_given.response, completed.response, possible, before.recorded_names());
    report.response_shrink->recording = run.string();
    report.why_no_response.clear();
  } catch (const ConfigError& error) {
    report.why_no_response = fmt::format("the test cannot be simulated: {}", error.what());
  } catch (const RecordingError& error) {
    report.why_no_response = fmt::format("the recorded response cannot be read: {}", error.what());
  }
}

}  // namespace hybridtest
