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
#include "diagnosis/tuning.hpp"
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

std::string diagnose_one(const std::string& id, const std::filesystem::path& run,
                         const std::filesystem::path& directory, const std::string& made_at_utc,
                         const PartProgress& progress) {
  SiteModelFile model = read_site_model(run / "scenario.yaml", id, {}, Dampers::beside_law);
  model.name = id;
  const std::vector<Recording> recordings{read_recording(run, RecordingRole::fit, id)};
  DiagnoseSettings settings;
  settings.threads = std::max(1U, std::thread::hardware_concurrency());
  settings.made_at_utc = made_at_utc;
  settings.progress = progress.part(0.0, tuning::kSiteDiagnosed);
  SiteDiagnosis diagnosis = diagnose_site(model, recordings, settings);
  diagnose_structure_of(diagnosis, run, run / "scenario.yaml",
                        progress.part(tuning::kSiteDiagnosed, tuning::kStructureDiagnosed));
  add_response(diagnosis, model, run, id, run / "scenario.yaml",
               progress.part(tuning::kStructureDiagnosed, tuning::kTestRerun));
  write_diagnosis(diagnosis, model, directory, progress.part(tuning::kTestRerun, 1.0));
  return "\ndiagnosis of " + id + ": " + summary_of(diagnosis) + "  written to " + directory.string() + "\n";
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

void diagnose_run(const Scenario& scenario, const std::filesystem::path& run, const std::string& made_at_utc,
                  const PartProgress& progress, std::ostream& out) {
  const std::vector<const SubstructureScenario*> sites = sites_of(scenario);
  std::string results;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const std::string& id = sites[i]->id;
    const std::filesystem::path directory = sites.size() == 1 ? run / "diagnosis" : run / "diagnosis" / id;
    if (!std::filesystem::exists(run_file(run, id))) {
      results += "\n" + id + " is not diagnosed: its recording is not in " + run.string() +
                 ". Copy it from the host of the site into this directory and use `hybridtest diagnose`\n";
      continue;
    }
    try {
      results += diagnose_one(id, run, directory, made_at_utc, progress.round(i, sites.size()));
    } catch (const ConfigError& error) {
      results += "\n" + id + " is not diagnosed: " + error.what() + "\n";
    }
  }
  progress.report("sites diagnosed", sites.size(), sites.size());
  out << results;
}

}  // namespace hybridtest
