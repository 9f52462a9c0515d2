#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <thread>

#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "diagnosis/runs/diagnose_site.hpp"
#include "diagnosis/runs/read_recording.hpp"
#include "diagnosis/runs/rerun.hpp"
#include "launch/commands.hpp"
#include "launch/diagnosis_progress.hpp"

namespace hybridtest {
namespace {

struct DiagnoseOptions {
  std::filesystem::path model;
  std::string site;
  std::vector<std::filesystem::path> recordings;
  std::vector<std::filesystem::path> held_out;
  std::filesystem::path scenario;
  std::filesystem::path out;
  std::uint64_t seed = 1;
  std::size_t threads = 0;
};

/// The first run directory, of those held out if there is one: it knows of what test the site was a part.
std::optional<std::filesystem::path> run_to_repeat(const DiagnoseOptions& options) {
  for (const auto* files : {&options.held_out, &options.recordings}) {
    const auto run = std::ranges::find_if(*files, [](const auto& file) { return std::filesystem::is_directory(file); });
    if (run != files->end()) return *run;
  }
  return {};
}

int run_diagnosis(const DiagnoseOptions& options) {
  const std::optional<std::filesystem::path> run = run_to_repeat(options);
  if (!run && !options.scenario.empty()) {
    throw ConfigError{"--scenario: a CSV does not hold what the structure received; give a run directory"};
  }
  const SiteModelFile model = read_site_model(options.model, options.site);
  std::vector<Recording> recordings;
  for (const std::filesystem::path& file : options.recordings) {
    recordings.push_back(read_recording(file, RecordingRole::fit, options.site));
  }
  for (const std::filesystem::path& file : options.held_out) {
    recordings.push_back(read_recording(file, RecordingRole::held_out, options.site));
  }
  DiagnoseSettings settings;
  settings.seed = options.seed;
  settings.threads = options.threads > 0 ? options.threads : std::max(1U, std::thread::hardware_concurrency());
  settings.progress = show_fits;
  SiteDiagnosis diagnosis = diagnose_site(model, recordings, settings);
  if (run) {
    const std::filesystem::path scenario = options.scenario.empty() ? *run / "scenario.yaml" : options.scenario;
    diagnose_structure_of(diagnosis, *run, scenario);
    add_response(diagnosis, model, *run, options.site, scenario, show_rerun);
  }
  write_diagnosis(diagnosis, model, options.out);
  fmt::print("{}\n  written to {}\n", summary_of(diagnosis), options.out.string());
  return diagnosis.diagnosis.report.verdict == report::Verdict::not_excited ? kExitDataInvalid : kExitCompleted;
}

}  // namespace

void add_diagnose_command(CLI::App& app, CommandAction& action) {
  auto options = std::make_shared<DiagnoseOptions>();
  CLI::App* command =
      app.add_subcommand("diagnose",
                         "Tell where recordings of a site and its model disagree, which effect causes it, and how far\n"
                         "the gap shrinks with it. Exit code 4: the recordings cannot tell.");
  command->add_option("--model", options->model, "Model of the site: a rig section, or a scenario")->required();
  command->add_option("--site", options->site, "Id of the substructure, where a scenario or run has several");
  command->add_option("--recording", options->recordings, "CSV or run directory to find the cause in; repeatable")
      ->required();
  command->add_option("--held-out", options->held_out, "CSV or run directory to measure the shrinking on; repeatable");
  command->add_option("--scenario", options->scenario,
                      "Scenario with the structure as you take it to be; without one, that of the run directory");
  command->add_option("--out", options->out, "Directory for diagnosis.json and augmented_model.yaml")->required();
  command->add_option("--seed", options->seed, "Of the resampling behind intervals")->capture_default_str();
  command->add_option("--threads", options->threads, "Threads to fit on; 0: one per core")->capture_default_str();
  command->callback([options, &action] { action = [options] { return run_diagnosis(*options); }; });
}

}  // namespace hybridtest
