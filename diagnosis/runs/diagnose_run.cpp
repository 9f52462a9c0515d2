#include "diagnosis/runs/diagnose_run.hpp"

#include <algorithm>
#include <ostream>
#include <string>
#include <thread>
#include <vector>

#include "core/config_error.hpp"
#include "core/text/shown.hpp"
#include "diagnosis/runs/diagnose_site.hpp"
#include "diagnosis/runs/rerun.hpp"
#include "diagnosis/runs/run_records.hpp"
#include "runtime/run_directory.hpp"
#include "scenario/site_model_file.hpp"

namespace hybridtest {
namespace {

std::vector<const SubstructureScenario*> sites_of(const Scenario& scenario) {
  std::vector<const SubstructureScenario*> sites;
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (substructure.role == Role::experimental_site) sites.push_back(&substructure);
  }
  return sites;
}

void diagnose_one(const std::string& id, const std::filesystem::path& run, const std::filesystem::path& directory,
                  const DiagnosisProgress& progress, std::ostream& out) {
  SiteModelFile model = read_site_model(run / "scenario.yaml", id);
  model.name = id;
  const std::vector<Recording> recordings{read_recording(run, RecordingRole::fit, id)};
  DiagnoseSettings settings;
  settings.threads = std::max(1U, std::thread::hardware_concurrency());
  settings.progress = progress.fits;
  SiteDiagnosis diagnosis = diagnose_site(model, recordings, settings);
  diagnose_structure_of(diagnosis, run, run / "scenario.yaml");
  add_response(diagnosis, model, run, id, run / "scenario.yaml", progress.rerun);
  write_diagnosis(diagnosis, model, directory);
  out << "\ndiagnosis of " << id << ": " << summary_of(diagnosis) << "  written to " << directory.string() << "\n";
}

}  // namespace

void require_models(const Scenario& scenario) {
  std::vector<std::string> without;
  for (const SubstructureScenario* site : sites_of(scenario)) {
    if (!site->site.has_model && site->site.rig_type != "simulated") without.push_back(site->id);
  }
  if (without.empty()) return;
  throw ConfigError{
      "--diagnose compares each site with its model, and a model is missing. Add `model: FILE` beside the rig of " +
      listed(without)};
}

void diagnose_run(const Scenario& scenario, const std::filesystem::path& run, const DiagnosisProgress& progress,
                  std::ostream& out) {
  const std::vector<const SubstructureScenario*> sites = sites_of(scenario);
  for (const SubstructureScenario* site : sites) {
    const std::filesystem::path directory = sites.size() == 1 ? run / "diagnosis" : run / "diagnosis" / site->id;
    if (!std::filesystem::exists(run_file(run, site->id))) {
      out << "\n"
          << site->id << " is not diagnosed: its recording is not in " << run.string()
          << ". Copy it from the host of the site into this directory and use `hybridtest diagnose`\n";
      continue;
    }
    try {
      diagnose_one(site->id, run, directory, progress, out);
    } catch (const ConfigError& error) {
      out << "\n" << site->id << " is not diagnosed: " << error.what() << "\n";
    }
  }
}

}  // namespace hybridtest
