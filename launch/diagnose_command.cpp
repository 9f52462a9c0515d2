#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <thread>

#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "diagnosis/runs/diagnose_site.hpp"
#include "diagnosis/runs/rerun.hpp"
#include "diagnosis/runs/run_records.hpp"
#include "diagnosis/tuning.hpp"
#include "launch/commands.hpp"
#include "launch/diagnosis_progress.hpp"
#include "runtime/run_directory.hpp"
#include "scenario/formula_file.hpp"

namespace hybridtest {
namespace {

struct DiagnoseOptions {
  std::filesystem::path model;
  std::string site;
  std::vector<std::filesystem::path> recordings;
  std::vector<std::filesystem::path> held_out;
  std::filesystem::path scenario;
  std::filesystem::path formulas;
  std::filesystem::path out;
  std::uint64_t seed = 1;
  std::size_t threads = 0;
  VerdictPolicy policy;
};

/// The first run directory, preferably a held-out one: a CSV file does not contain the whole test.
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
    throw ConfigError{
        "--scenario: only CSV files are given; expected a run directory as --recording or --held-out, because a CSV "
        "file does not contain the commands and forces of the structure"};
  }
  std::vector<std::filesystem::path> files = options.recordings;
  files.insert(files.end(), options.held_out.begin(), options.held_out.end());
  SiteModelFile model = read_model_for(files, options.model, options.site);
  if (!options.formulas.empty()) {
    const std::vector<const EffectType*> formulas = read_formulas(options.formulas);
    for (SiteModel& dof : model.dofs) dof.suspected = formulas;
  }
  std::vector<Recording> recordings;
  for (const std::filesystem::path& file : options.recordings) {
    recordings.push_back(read_recording(file, RecordingRole::fit, options.site, time_base_of(model)));
  }
  for (const std::filesystem::path& file : options.held_out) {
    recordings.push_back(read_recording(file, RecordingRole::held_out, options.site, time_base_of(model)));
  }
  DiagnoseSettings settings;
  settings.seed = options.seed;
  settings.threads = options.threads > 0 ? options.threads : std::max(1U, std::thread::hardware_concurrency());
  settings.policy = options.policy;
  if (settings.policy.partial_leaves < settings.policy.named_leaves) {
    throw ConfigError{fmt::format("--partial-leaves {} is less than --named-leaves {}; expected at least as much",
                                  settings.policy.partial_leaves, settings.policy.named_leaves)};
  }
  settings.made_at_utc = time_utc();
  SiteDiagnosis diagnosis;
  {
    DiagnosisProgress display{stderr};
    const PartProgress progress = display.whole();
    settings.progress = progress.part(0.0, tuning::kSiteDiagnosed);
    diagnosis = diagnose_site(model, recordings, settings);
    if (run) {
      const std::filesystem::path scenario = options.scenario.empty() ? *run / "scenario.yaml" : options.scenario;
      diagnose_structure_of(diagnosis, *run, scenario,
                            progress.part(tuning::kSiteDiagnosed, tuning::kStructureDiagnosed));
      add_response(diagnosis, model, *run, options.site, scenario,
                   progress.part(tuning::kStructureDiagnosed, tuning::kTestRerun));
    }
    write_diagnosis(diagnosis, model, options.out, progress.part(tuning::kTestRerun, 1.0));
  }
  fmt::print("{}\n  written to {}\n", summary_of(diagnosis), options.out.string());
  return diagnosis.diagnosis.report.verdict == report::Verdict::not_excited ? kExitDataInvalid : kExitCompleted;
}

}  // namespace

void add_diagnose_command(CLI::App& app, CommandAction& action) {
  auto options = std::make_shared<DiagnoseOptions>();
  CLI::App* command = app.add_subcommand(
      "diagnose",
      "Find where recordings of a site and its model disagree, which unmodelled effect explains the gap,\n"
      "and how much of the gap remains with it. Exit code 4: the recordings are not sufficient.");
  command->add_option("--model", options->model, "Model of the site: a site file, or a scenario")->required();
  command->add_option("--site", options->site, "Id of the site; required if the scenario or run has several sites");
  command
      ->add_option("--recording", options->recordings,
                   "CSV file or run directory to which effects are fitted; repeatable")
      ->required();
  command->add_option(
      "--held-out", options->held_out,
      "CSV file or run directory, not used for fitting, on which the remaining gap is measured; repeatable");
  command->add_option(
      "--scenario", options->scenario,
      "Scenario with the mass, damping, stiffness and step to be checked; default: the scenario of the run\n"
      "directory");
  command->add_option("--formulas", options->formulas,
                      "YAML file with forces of the specimen, written as formulas, that are tried beside the library");
  command->add_option("--out", options->out, "Directory for diagnosis.html, diagnosis.json and augmented_model.yaml")
      ->required();
  command->add_option("--seed", options->seed, "Seed of the resampling for the confidence intervals")
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Number of threads; 0: one per core")->capture_default_str();
  constexpr auto kPolicy = "What counts as a cause";
  const CLI::Range share{0.0, 1.0};
  command
      ->add_option(
          "--named-leaves", options->policy.named_leaves,
          "Share of the gap's energy up to which its cause is named though more than the floor is left, 0 to 1")
      ->check(share)
      ->capture_default_str()
      ->group(kPolicy);
  command
      ->add_option("--partial-leaves", options->policy.partial_leaves,
                   "Share up to which it is named in part; with more left the gap is unknown")
      ->check(share)
      ->capture_default_str()
      ->group(kPolicy);
  command->add_option("--credible", options->policy.credible, "Probability of a set of effects, 0.5 to 0.999")
      ->check(CLI::Range{0.5, 0.999})
      ->capture_default_str()
      ->group(kPolicy);
  command
      ->add_option("--numbers-within", options->policy.numbers_within,
                   "Share of the output up to which a wrong number of the model is corrected without being a cause")
      ->check(share)
      ->capture_default_str()
      ->group(kPolicy);
  command->callback([options, &action] { action = [options] { return run_diagnosis(*options); }; });
}

}  // namespace hybridtest
