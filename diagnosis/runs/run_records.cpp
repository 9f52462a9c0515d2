#include "diagnosis/runs/run_records.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/config_error.hpp"
#include "core/input_file.hpp"
#include "core/text/shown.hpp"
#include "diagnosis/intake/intake.hpp"
#include "diagnosis/tuning.hpp"
#include "recording/error.hpp"
#include "recording/run_file.hpp"
#include "recording/run_file_reader.hpp"
#include "runtime/participant.hpp"
#include "runtime/run_directory.hpp"
#include "scenario/scenario.hpp"
#include "scenario/scenario_digest.hpp"

namespace hybridtest {

namespace {

Scenario scenario_of(const std::filesystem::path& run) { return read_scenario(run / "scenario.yaml", {}); }

const SubstructureScenario& site_of(const Scenario& scenario, const std::filesystem::path& run, std::string_view id) {
  std::vector<std::string> sites;
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (substructure.role == Role::experimental_site) sites.push_back(substructure.id);
  }
  const std::string known = "; the sites of " + run.string() + " are " + listed(sites);
  if (sites.empty())
    throw ConfigError{run.string() +
                      ": this run has no experimental site; expected the run directory of a test with one"};
  if (id.empty() && sites.size() > 1)
    throw ConfigError{"--site is missing and the run has several sites; expected the id of one" + known};
  const SubstructureScenario* site = scenario.find(id.empty() ? std::string_view{sites.front()} : id);
  if (site == nullptr || site->role != Role::experimental_site) {
    throw ConfigError{"--site " + std::string{id} + ": no such site" + known};
  }
  return *site;
}

/// A diagnosis keeps all signals in memory.
void require_room(const RunFileReader& file, std::string_view table, std::string_view advice) {
  const std::size_t rows = file.row_count(table);
  if (rows <= tuning::kSamplesMax) return;
  throw RecordingError{
      fmt::format("{}: the table {} has {} rows; expected at most {}, because a diagnosis keeps them in "
                  "memory; {}",
                  file.path().string(), table, rows, tuning::kSamplesMax, advice)};
}

/// Displacement and velocity of one interface degree of freedom at the coordinator's steps.
struct SentMotion {
  std::vector<double> model_time_s;
  std::vector<double> displacement_m;
  std::vector<double> velocity_m_per_s;  // per second of model time

  /// Cubic between two steps; constant before the first step and after the last one.
  [[nodiscard]] double at(double time_s) const {
    const auto after = std::ranges::upper_bound(model_time_s, time_s);
    if (after == model_time_s.begin()) return displacement_m.front();
    if (after == model_time_s.end()) return displacement_m.back();
    const auto i = static_cast<std::size_t>(after - model_time_s.begin()) - 1;
    const double step_s = model_time_s[i + 1] - model_time_s[i];
    const double u = (time_s - model_time_s[i]) / step_s;
    const double from = (1.0 + 2.0 * u) * (1.0 - u) * (1.0 - u) * displacement_m[i] +
                        u * (1.0 - u) * (1.0 - u) * step_s * velocity_m_per_s[i];
    const double to =
        u * u * (3.0 - 2.0 * u) * displacement_m[i + 1] - u * u * (1.0 - u) * step_s * velocity_m_per_s[i + 1];
    return from + to;
  }
};

/// A recorded quantity of the structure at one interface: a row per interface degree of freedom, a
/// column per step.
Eigen::MatrixXd at_interface(const RunFileReader& coordinator, const Scenario& scenario, const InterfaceMap& interface,
                             const std::string& quantity, const std::string& unit) {
  Eigen::MatrixXd structure =
      Eigen::MatrixXd::Zero(interface.structure_size(), static_cast<Eigen::Index>(coordinator.row_count("steps")));
  for (Eigen::Index dof = 0; dof < structure.rows(); ++dof) {
    if (!interface.uses(dof)) continue;
    const std::vector<double> values = coordinator.column(
        "steps", std::string{quantity}.append(scenario.dofs[static_cast<std::size_t>(dof)]).append(unit));
    structure.row(dof) = Eigen::Map<const Eigen::RowVectorXd>{values.data(), structure.cols()};
  }
  Eigen::MatrixXd at_interface{interface.size(), structure.cols()};
  InterfaceVector values;
  for (Eigen::Index step = 0; step < structure.cols(); ++step) {
    interface.to_interface(structure.col(step), values);
    at_interface.col(step) = values;
  }
  return at_interface;
}

std::function<std::vector<double>(const std::string&)> steps_of(const RunFileReader& coordinator) {
  return [&coordinator](const std::string& name) { return coordinator.column("steps", name); };
}

/// What the integrator commanded, one column per step.
struct CommandedMotion {
  Eigen::MatrixXd displacement_m;
  Eigen::MatrixXd velocity_m_per_s;
};

/// Steps the integrator through the recorded forces again: a command that it corrects afterwards is not recorded.
CommandedMotion commanded_motion(const Scenario& ran, const TestResponse& response) {
  const auto integrator = ran.make_integrator();
  CommandedMotion commanded{response.displacement_m, response.velocity_m_per_s};
  for (Eigen::Index i = 0; i < response.steps(); ++i) {
    commanded.displacement_m.col(i) = integrator->current().displacement_m;
    commanded.velocity_m_per_s.col(i) = integrator->current().velocity_m_per_s;
    integrator->advance(response.restoring_force_n.col(i), response.applied_force_n.col(i));
  }
  return commanded;
}

/// One motion per interface degree of freedom.
std::vector<SentMotion> sent_motions(const RunFileReader& coordinator, const Scenario& scenario,
                                     const InterfaceMap& interface) {
  const bool records_all_dofs = scenario.recorded_dofs.size() == scenario.dofs.size();
  const Eigen::MatrixXd displacement_m =
      scenario.integrator.needs.corrects_displacement && records_all_dofs
          ? Eigen::MatrixXd{interface.matrix() *
                            commanded_motion(scenario, response_of_steps(scenario, steps_of(coordinator)))
                                .displacement_m}
          : at_interface(coordinator, scenario, interface, "displacement_", "_m");
  const Eigen::MatrixXd velocity_m_per_s = at_interface(coordinator, scenario, interface, "velocity_", "_m_per_s");
  std::vector<SentMotion> sent(static_cast<std::size_t>(interface.size()));
  for (Eigen::Index k = 0; k < interface.size(); ++k) {
    SentMotion& motion = sent[static_cast<std::size_t>(k)];
    motion.model_time_s = coordinator.column("steps", "model_time_s");
    motion.displacement_m.assign(displacement_m.row(k).begin(), displacement_m.row(k).end());
    motion.velocity_m_per_s.assign(velocity_m_per_s.row(k).begin(), velocity_m_per_s.row(k).end());
  }
  return sent;
}

/// Model time of each control sample if every command arrived on time: site time divided by the time scale,
/// counted from the sample at which model time started.
std::vector<double> planned_model_time_s(const RunFileReader& site, double time_scale) {
  std::vector<double> time_s = site.column("control", std::string{kTimeColumn});
  const std::vector<double> model_time_s = site.column("control", "model_time_s");
  const auto running = std::ranges::find_if(model_time_s, [](double time) { return time > 0.0; });
  if (running == model_time_s.end()) return std::vector<double>(time_s.size(), 0.0);
  const auto first = static_cast<std::size_t>(running - model_time_s.begin());
  const double begin_s = time_s[first] - *running * time_scale;
  for (double& time : time_s) time = (time - begin_s) / time_scale;
  return time_s;
}

void add_sent(RawRecording& raw, const RunFileReader& site, const Scenario& scenario,
              const SubstructureScenario& substructure, const std::filesystem::path& coordinator_file) {
  const RunFileReader coordinator{coordinator_file};
  if (coordinator.row_count("steps") == 0) return;
  require_room(coordinator, "steps", "diagnose a CSV file of the site");
  const std::vector<double> model_time_s = planned_model_time_s(site, scenario.time.time_scale);
  const std::vector<SentMotion> motions = sent_motions(coordinator, scenario, substructure.interface);
  for (std::size_t dof = 0; dof < motions.size(); ++dof) {
    RawColumn column{std::string{column_name(Channel::sent_displacement)}, Channel::sent_displacement, dof, {}};
    for (const double time : model_time_s) column.values.push_back(motions[dof].at(time));
    raw.columns.push_back(std::move(column));
  }
}

void add_control_table(RawRecording& raw, const RunFileReader& site) {
  for (const TableLayout& table : site.tables()) {
    if (table.name != "control") continue;
    for (const Column& column : table.columns) {
      if (const auto place = channel_of_header(column.name)) {
        raw.columns.push_back({column.name, place->channel, place->dof, site.column(table.name, column.name)});
      }
    }
  }
  raw.time_s = site.column("control", std::string{kTimeColumn});
}

/// Removes the samples after the last target: there the site returns to rest without its compensator, which is
/// not part of the test.
void cut_return(RawRecording& raw, const RunFileReader& site) {
  const std::vector<double> model_time_s = site.column("control", "model_time_s");
  const auto last = std::ranges::max_element(model_time_s);  // the first of equals: path time stands still from there
  const auto samples = std::min(raw.time_s.size(), static_cast<std::size_t>(last - model_time_s.begin()) + 1);
  raw.time_s.resize(samples);
  for (RawColumn& column : raw.columns) column.values.resize(samples);
}

}  // namespace

std::string site_of_run(const std::filesystem::path& run, std::string_view site) {
  const Scenario scenario = scenario_of(run);
  return site_of(scenario, run, site).id;
}

SiteModelFile read_model_for(std::span<const std::filesystem::path> recordings, const std::filesystem::path& model,
                             std::string_view site) {
  SiteModelFile given = read_site_model(model, site, {}, Dampers::beside_law);
  if (!given.compensators.empty()) return given;
  std::optional<std::string> of_runs;
  for (const std::filesystem::path& run : recordings) {
    if (!std::filesystem::is_directory(run)) continue;
    const std::string of_run = compensators_of_site(run / "scenario.yaml", site_of_run(run, site));
    if (of_runs && *of_runs != of_run) {
      throw ConfigError{model.string() +
                        ": this model names no compensator, and the sites of the runs have different ones; expected "
                        "`compensator` in the model, or runs with the same one"};
    }
    of_runs = of_run;
  }
  return of_runs && !of_runs->empty() ? read_site_model(model, site, *of_runs, Dampers::beside_law) : given;
}

std::filesystem::path site_run_file(const std::filesystem::path& run, std::string_view site) {
  return run_file(run, site_of_run(run, site));
}

RawRecording raw_recording_of_run(const std::filesystem::path& run, std::string_view site) try {
  const Scenario scenario = scenario_of(run);
  const SubstructureScenario& substructure = site_of(scenario, run, site);
  const RunFileReader file{run_file(run, substructure.id)};
  require_room(file, "control",
               fmt::format("use `hybridtest export {} --csv` and diagnose a part of csv/{}.control.csv", run.string(),
                           substructure.id));
  RawRecording raw;
  raw.file = run.string();
  add_control_table(raw, file);
  const std::filesystem::path coordinator = run_file(run, kCoordinatorId);
  if (std::filesystem::exists(coordinator)) add_sent(raw, file, scenario, substructure, coordinator);
  cut_return(raw, file);
  return raw;
} catch (const RecordingError& error) {
  throw ConfigError{error.what()};
}

namespace {

std::string content_of(const std::filesystem::path& path) {
  return read_input_file(path, tuning::kFileSizeMax_bytes, "a recording; of a larger one, export a part");
}

Recording accepted(Intake intake, const std::string& file) {
  if (intake.recording) return std::move(*intake.recording);
  std::vector<ConfigIssue> issues;
  // The text of a finding already contains file and row.
  for (const IntakeFinding& finding : intake.findings) issues.push_back({.file = {}, .what = finding.text(file)});
  throw ConfigError{std::move(issues)};
}

}  // namespace

Recording read_recording(const std::filesystem::path& path, RecordingRole role, std::string_view site, TimeBase time) {
  const std::string file = path.string();
  Recording recording;
  if (std::filesystem::is_directory(path)) {
    recording = accepted(check_recording(raw_recording_of_run(path, site), time), file);
    recording.sha256 = hex(sha256_of_file(site_run_file(path, site)));
  } else {
    const std::string text = content_of(path);
    recording = accepted(read_csv_recording(text, file, time), file);
    recording.sha256 = hex(sha256(text));
  }
  recording.role = role;
  return recording;
}

namespace {

using StepColumn = std::function<std::vector<double>(const std::string&)>;

Eigen::MatrixXd rows_of(const std::vector<std::string>& names, const StepColumn& column) {
  Eigen::MatrixXd rows(std::ssize(names), std::ssize(column("step")));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::vector<double> values = column(names[i]);
    rows.row(static_cast<Eigen::Index>(i)) = Eigen::Map<const Eigen::RowVectorXd>{values.data(), std::ssize(values)};
  }
  return rows;
}

/// A row for each ground motion, as Coordinator::steps_layout() names them.
Eigen::MatrixXd recorded_ground_motions(const Scenario& scenario, const StepColumn& column) {
  std::vector<std::string> names;
  for (std::size_t k = 1; k <= scenario.excitation.records.size(); ++k) {
    names.push_back("ground_acceleration_" + (k == 1 ? "" : std::to_string(k) + "_") + "m_per_s2");
  }
  return rows_of(names, column);
}

/// A row for each recorded degree of freedom; without columns where the test applies no forces.
Eigen::MatrixXd recorded_applied_forces(const Scenario& scenario, const StepColumn& column) {
  if (scenario.excitation.forces.empty()) return {};
  std::vector<std::string> names;
  for (const std::string& dof : scenario.recorded_names()) names.push_back("applied_force_" + dof + "_n");
  return rows_of(names, column);
}

}  // namespace

TestResponse recorded_response(const std::filesystem::path& run, const Scenario& scenario) {
  const RunFileReader coordinator{run_file(run, kCoordinatorId)};
  require_room(coordinator, "steps", "the structure is not compared");
  return response_of_steps(scenario, steps_of(coordinator));
}

TestResponse response_of_steps(const Scenario& scenario,
                               const std::function<std::vector<double>(const std::string&)>& column) {
  TestResponse response;
  response.step_s = scenario.time.step_s;
  const auto row_of = [&](const std::string& name) {
    const std::vector<double> values = column(name);
    return Eigen::RowVectorXd{Eigen::Map<const Eigen::RowVectorXd>{values.data(), std::ssize(values)}};
  };
  const auto steps = std::ssize(column("step"));
  const std::vector<std::string> names = scenario.recorded_names();
  const auto dofs = std::ssize(names);
  for (Eigen::MatrixXd* signal : {&response.displacement_m, &response.velocity_m_per_s, &response.restoring_force_n}) {
    signal->resize(dofs, steps);
  }
  for (Eigen::Index i = 0; i < dofs; ++i) {
    const std::string& dof = names[static_cast<std::size_t>(i)];
    response.displacement_m.row(i) = row_of("displacement_" + dof + "_m");
    response.velocity_m_per_s.row(i) = row_of("velocity_" + dof + "_m_per_s");
    response.restoring_force_n.row(i) = row_of("restoring_force_" + dof + "_n");
  }
  response.applied_force_n.setZero(dofs, steps);
  const Eigen::MatrixXd ground_m_per_s2 = recorded_ground_motions(scenario, column);
  for (std::size_t k = 0; k < scenario.excitation.records.size(); ++k) {
    const Eigen::VectorXd load_kg = -(scenario.structure.mass_kg * scenario.excitation.records[k].influence);
    response.applied_force_n += load_kg(scenario.recorded_dofs) * ground_m_per_s2.row(static_cast<Eigen::Index>(k));
  }
  const Eigen::MatrixXd forces_n = recorded_applied_forces(scenario, column);
  if (forces_n.cols() > 0) response.applied_force_n += forces_n;
  return response;
}

namespace {

void require_same_test(const Scenario& scenario, const Scenario& ran) {
  const std::string what = scenario.file.string() + ": this scenario is not the one of the recorded test: ";
  if (scenario.dofs != ran.dofs)
    throw ConfigError{what + "the names or the order of the degrees of freedom differ; expected the same"};
  const bool same = std::ranges::equal(scenario.substructures, ran.substructures, [](const auto& a, const auto& b) {
    return a.id == b.id && a.role == b.role && a.interface_names == b.interface_names;
  });
  if (!same) throw ConfigError{what + "the substructures or their interfaces differ; expected the same"};
  if (scenario.excitation.records.size() != ran.excitation.records.size()) {
    throw ConfigError{what + "the number of ground motions differs; expected the same"};
  }
}

/// The forces of a numerical substructure, one column per step; nothing if a step is missing.
std::optional<Eigen::MatrixXd> recorded_forces(const RunFileReader& file, const SubstructureScenario& substructure,
                                               Eigen::Index steps) {
  Eigen::MatrixXd forces_n(substructure.interface.size(), steps);
  const std::vector<double> numbers = file.column("steps", "step");
  if (std::ssize(numbers) < steps) return {};
  for (Eigen::Index i = 0; i < steps; ++i) {
    if (numbers[static_cast<std::size_t>(i)] != static_cast<double>(i)) return {};
  }
  for (Eigen::Index k = 0; k < forces_n.rows(); ++k) {
    const std::string& name = substructure.interface_names[static_cast<std::size_t>(k)];
    const std::vector<double> values = file.column("steps", "force_" + name + "_n");
    forces_n.row(k) = Eigen::Map<const Eigen::RowVectorXd>{values.data(), steps};
  }
  return forces_n;
}

/// K u of the elastic part of the structure, at each step.
void add_elastic_forces(const LinearStructure& structure, const Eigen::MatrixXd& displacement_m,
                        Eigen::MatrixXd& force_n) {
  if (structure.stiffness_n_per_m.nonZeros() > 0) force_n += structure.stiffness_n_per_m * displacement_m;
}

/// Forces of the elastic part and of the numerical substructures, recorded and modelled; omitted if one substructure
/// has no recording. @param ran   the scenario of the run; the recorded force of the elastic part follows from it.
void add_numerical_forces(const std::filesystem::path& run, const Scenario& scenario, const Scenario& ran,
                          const CommandedMotion& commanded, StructureRecord& record) {
  StructureRecording& recording = record.recording;
  Eigen::MatrixXd recorded_n = Eigen::MatrixXd::Zero(recording.displacement_m.rows(), recording.steps());
  Eigen::MatrixXd modelled_n = recorded_n;
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (substructure.role != Role::numerical_substructure) continue;
    std::optional<Eigen::MatrixXd> forces_n;
    if (std::filesystem::exists(run_file(run, substructure.id))) {
      forces_n = recorded_forces(RunFileReader{run_file(run, substructure.id)}, substructure, recording.steps());
    }
    if (!forces_n) {
      record.notes.push_back("Forces of " + substructure.id + " are missing in " + run.string() +
                             ": the stiffness of the numerical substructures is not checked.");
      return;
    }
    const auto model = substructure.make_model();
    model->start({});
    model->reset();
    const InterfaceMap& interface = substructure.interface;
    InterfaceVector displacement_m;
    InterfaceVector velocity_m_per_s;
    InterfaceVector force_n = InterfaceVector::Zero(interface.size());
    for (Eigen::Index i = 0; i < recording.steps(); ++i) {
      interface.to_interface(commanded.displacement_m.col(i), displacement_m);
      interface.to_interface(commanded.velocity_m_per_s.col(i), velocity_m_per_s);
      model->trial(displacement_m, velocity_m_per_s, force_n);
      model->commit();
      interface.add_to_structure(force_n, modelled_n.col(i));
      interface.add_to_structure(forces_n->col(i), recorded_n.col(i));
    }
  }
  add_elastic_forces(ran.structure, commanded.displacement_m, recorded_n);
  add_elastic_forces(scenario.structure, commanded.displacement_m, modelled_n);
  recording.numerical_force_n = std::move(recorded_n);
  recording.modelled_numerical_force_n = std::move(modelled_n);
}

/// Adds notes on differences of the configuration for which there is no effect.
void note_differences(const Scenario& scenario, const Scenario& ran, const StructureRecording& recording,
                      std::vector<std::string>& notes) {
  if (scenario.integrator.text != ran.integrator.text) {
    notes.push_back(fmt::format("The integrator of the scenario is {}, that of the recorded test is {}.",
                                scenario.integrator.text, ran.integrator.text));
  }
  if (scenario.time.step_s != ran.time.step_s) {
    notes.push_back(fmt::format("The step of the scenario is {} s, that of the recorded test is {} s.",
                                scenario.time.step_s, ran.time.step_s));
    return;
  }
  const Eigen::MatrixXd& ground_m_per_s2 = recording.ground_m_per_s2;
  for (std::size_t k = 0; k < scenario.excitation.records.size(); ++k) {
    const std::vector<double>& values = scenario.excitation.records[k].acceleration_m_per_s2;
    const auto steps = std::min<Eigen::Index>(ground_m_per_s2.cols(), std::ssize(values));
    const Eigen::Map<const Eigen::RowVectorXd> own{values.data(), steps};
    const Eigen::RowVectorXd recorded = ground_m_per_s2.row(static_cast<Eigen::Index>(k)).head(steps);
    const double off = (own - recorded).norm();
    if (off <= tuning::kRounding * recorded.norm()) continue;
    notes.push_back(
        fmt::format("The ground motion {} of the scenario differs from the recorded one by {:.3g} of its root mean "
                    "square. The recorded ground motion is used.",
                    k + 1, off / recorded.norm()));
  }
}

}  // namespace

StructureRecord structure_record(const std::filesystem::path& run, const Scenario& scenario) {
  const Scenario ran = read_scenario(run / "scenario.yaml", {});
  if (ran.opensees || scenario.opensees) {
    throw RecordingError{run.string() +
                         ": OpenSees led this test, and its model of the structure is not known here: the structure "
                         "cannot be recomputed. The sites can be diagnosed (--site)"};
  }
  require_same_test(scenario, ran);
  for (const Scenario* tried : {&scenario, &ran}) {
    if (!tried->integrator.needs.tries_displacements) continue;
    throw RecordingError{
        fmt::format("{}: the integrator {} tries several displacements in a step, and the forces of the trials are not "
                    "recorded: the "
                    "structure cannot be recomputed; expected an integrator that commands each displacement once",
                    run.string(), tried->integrator.type)};
  }
  const RunFileReader coordinator{run_file(run, kCoordinatorId)};
  if (ran.recorded_dofs.size() < ran.dofs.size()) {
    throw RecordingError{
        fmt::format("{}: the output of the scenario has {} of {} degrees of freedom, and the structure "
                    "cannot be recomputed; expected all of them in the recording",
                    run.string(), ran.recorded_dofs.size(), ran.dofs.size())};
  }
  const TestResponse response = recorded_response(run, ran);
  if (response.steps() == 0)
    throw RecordingError{run.string() + ": the coordinator completed no step; expected a test with at least one step"};
  StructureRecord record;
  record.model.structure = scenario.structure;
  record.model.step_s = scenario.integrator_step_s;
  record.model.make_integrator = [integrator = scenario.integrator, start = scenario.excitation.free_vibration](
                                     const LinearStructure& structure, double step_s) {
    return begun_integrator(integrator, start, structure, step_s);
  };
  record.model.influence.resize(scenario.structure.size(), std::ssize(scenario.excitation.records));
  for (std::size_t k = 0; k < scenario.excitation.records.size(); ++k) {
    record.model.influence.col(static_cast<Eigen::Index>(k)) = scenario.excitation.records[k].influence;
  }
  record.recording.step_s = ran.time.step_s;
  record.recording.ground_m_per_s2 = recorded_ground_motions(ran, steps_of(coordinator));
  record.recording.forces_n = recorded_applied_forces(ran, steps_of(coordinator));
  record.recording.displacement_m = response.displacement_m;
  record.recording.restoring_force_n = response.restoring_force_n;
  note_differences(scenario, ran, record.recording, record.notes);
  add_numerical_forces(run, scenario, ran, commanded_motion(ran, response), record);
  return record;
}

}  // namespace hybridtest
