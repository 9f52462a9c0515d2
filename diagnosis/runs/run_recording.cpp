#include "diagnosis/runs/run_recording.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/config_error.hpp"
#include "core/text/shown.hpp"
#include "diagnosis/intake/column_header.hpp"
#include "recording/error.hpp"
#include "recording/run_file_reader.hpp"
#include "runtime/participant.hpp"
#include "runtime/run_directory.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {
namespace {

Scenario scenario_of(const std::filesystem::path& run) { return read_scenario(run / "scenario.yaml", {}); }

const SubstructureScenario& site_of(const Scenario& scenario, const std::filesystem::path& run, std::string_view id) {
  std::vector<std::string> sites;
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (substructure.role == Role::experimental_site) sites.push_back(substructure.id);
  }
  const std::string known = "; sites of " + run.string() + ": " + listed(sites);
  if (sites.empty()) throw ConfigError{run.string() + ": this run has no experimental site"};
  if (id.empty() && sites.size() > 1) throw ConfigError{"--site: which site?" + known};
  const SubstructureScenario* site = scenario.find(id.empty() ? std::string_view{sites.front()} : id);
  if (site == nullptr || site->role != Role::experimental_site) {
    throw ConfigError{"--site " + std::string{id} + ": no such site" + known};
  }
  return *site;
}

/// Displacement and velocity of one interface degree of freedom at the coordinator's steps.
struct SentMotion {
  std::vector<double> model_time_s;
  std::vector<double> displacement_m;
  std::vector<double> velocity_m_per_s;  // per second of model time

  /// Cubic through both ends of the step; held before the first and after the last.
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
    const std::vector<double> values =
        coordinator.column("steps", quantity + scenario.dofs[static_cast<std::size_t>(dof)] + unit);
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

/// One motion per interface degree of freedom.
std::vector<SentMotion> sent_motions(const RunFileReader& coordinator, const Scenario& scenario,
                                     const InterfaceMap& interface) {
  const Eigen::MatrixXd displacement_m = at_interface(coordinator, scenario, interface, "displacement_", "_m");
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

/// Model time of each control sample if every command came in time: site time over the scale,
/// counted from the sample at which path time began to run.
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

/// Leaves out what comes after the last target: the site returning to rest, alone and without its
/// compensator, is no part of the test.
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

std::filesystem::path site_run_file(const std::filesystem::path& run, std::string_view site) {
  return run_file(run, site_of_run(run, site));
}

RawRecording raw_recording_of_run(const std::filesystem::path& run, std::string_view site) try {
  const Scenario scenario = scenario_of(run);
  const SubstructureScenario& substructure = site_of(scenario, run, site);
  const RunFileReader file{run_file(run, substructure.id)};
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

}  // namespace hybridtest
