#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "launch/shipped_scenarios.hpp"
#include "validation/studies/compensator_character/character_study.hpp"
#include "validation/studies/founding_study/founding_report.hpp"
#include "validation/studies/output_file.hpp"
#include "validation/studies/parallel_runs.hpp"
#include "validation/studies/rths_benchmark/recorded_run.hpp"
#include "validation/studies/rths_benchmark/rths_page.hpp"
#include "validation/studies/rths_benchmark/rths_tables.hpp"

namespace hybridtest {
namespace {

struct StudyOptions {
  std::filesystem::path directory;
  unsigned threads = usable_threads();
};

struct RthsOptions : StudyOptions {
  int plants = 20;
  std::uint64_t seed = 1;
  std::vector<std::string> compensators;
  std::filesystem::path ground_motions;
};

struct RecordedOptions {
  std::vector<std::filesystem::path> runs;
  std::filesystem::path ground_motions;
  std::filesystem::path csv;
};

struct FoundingOptions : StudyOptions {
  std::filesystem::path scenarios = shipped_scenarios() / "founding_study";
};

void say_where(const std::filesystem::path& directory, std::string_view files) {
  fmt::print("\nWritten to {}: {}\n", directory.string(), files);
}

int study_rths_benchmark(const RthsOptions& options) {
  const std::vector<rths::Candidate> candidates = rths::chosen_candidates(options.compensators);
  const rths::BenchmarkInputs inputs{rths::ground_motion_directory(options.ground_motions)};
  prepare_output_directory(options.directory);

  fmt::print("Check of the benchmark harness against the published values of the released controller:\n\n");
  const rths::HarnessCheck check = rths::check_harness(inputs, options.threads);
  fmt::print("{}\n", rths::to_markdown(check));
  std::fflush(stdout);
  if (!check.is_confirmed()) return kExitDataInvalid;

  const rths::StudySettings settings{options.plants, options.seed, options.threads};
  std::vector<rths::StudyRun> runs;
  {
    StudyProgress progress{rths::study_size(candidates.size(), settings), stderr};
    runs = rths::run_study(inputs, candidates, settings, progress);
  }
  write_output_file(options.directory / "table.csv", rths::criteria_csv(candidates, runs));
  write_output_file(options.directory / "tracking.csv", rths::tracking_csv(inputs, candidates, runs));
  write_output_file(options.directory / "summary.md",
                    rths::summary_markdown(inputs, check, candidates, runs, settings));
  write_output_file(options.directory / "errors.svg", rths::error_figure(inputs, candidates, runs));
  write_output_file(options.directory / "plots.html", rths::page_html(inputs, candidates, runs, settings));
  for (const rths::Target& target : rths::judge_ours(rths::means_of(inputs, candidates, runs))) {
    fmt::print("{:7} {}: {} (target: {})\n", target.is_met ? "met" : "MISSED", target.what, target.found, target.limit);
  }
  say_where(options.directory, "summary.md, table.csv, tracking.csv, plots.html, errors.svg");
  return kExitCompleted;
}

int study_recorded_runs(const RecordedOptions& options) {
  const rths::BenchmarkInputs inputs{rths::ground_motion_directory(options.ground_motions)};
  std::vector<rths::RecordedRun> runs;
  for (const std::filesystem::path& directory : options.runs)
    runs.push_back(rths::read_recorded_run(directory, inputs));
  fmt::print("{}", rths::recorded_markdown(runs));
  if (!options.csv.empty()) write_output_file(options.csv, rths::recorded_csv(runs));
  const bool is_complete = std::ranges::all_of(runs, &rths::RecordedRun::is_complete);
  return is_complete ? kExitCompleted : kExitEndedEarly;
}

int study_founding_study(const FoundingOptions& options) {
  prepare_output_directory(options.directory);
  std::vector<founding::MethodRun> runs;
  {
    StudyProgress progress{founding::kMethods.size(), stderr};
    runs = founding::run_founding_study(options.scenarios, options.threads, progress);
  }
  write_output_file(options.directory / "table.csv", founding::table_csv(runs));
  write_output_file(options.directory / "summary.md", founding::summary_markdown(runs));
  write_output_file(options.directory / "plots.html", founding::page_html(runs));
  for (const founding::Finding& finding : founding::find(runs)) {
    fmt::print("{:10}{}: {}\n", finding.is_shown ? "shown" : "NOT SHOWN", finding.what, finding.shown_by);
  }
  say_where(options.directory, "summary.md, table.csv, plots.html");
  return kExitCompleted;
}

int study_compensators(const StudyOptions& options) {
  prepare_output_directory(options.directory);
  character::CharacterStudy study;
  {
    StudyProgress progress{character::character_study_size(), stderr};
    study = character::run_character_study(options.threads, progress);
  }
  write_output_file(options.directory / "frequency_response.csv", character::frequency_response_csv(study));
  write_output_file(options.directory / "loop_damping.csv", character::loop_damping_csv(study));
  write_output_file(options.directory / "noise_gain.csv", character::noise_gain_csv(study));
  write_output_file(options.directory / "summary.md", character::summary_markdown(study));
  write_output_file(options.directory / "response_pure_delay.svg", character::pure_delay_figure(study));
  write_output_file(options.directory / "response_benchmark_actuator.svg", character::benchmark_figure(study));
  write_output_file(options.directory / "noise_gain.svg", character::noise_figure(study));
  write_output_file(options.directory / "loop_damping.svg", character::damping_figure(study));
  say_where(options.directory, "summary.md, three tables (.csv) and four figures (.svg)");
  return kExitCompleted;
}

void add_ground_motions(CLI::App& study, std::filesystem::path& ground_motions) {
  study
      .add_option("--ground-motions", ground_motions,
                  "Directory with rths_benchmark_elcentro.csv, _kobe.csv and _morgan.csv")
      ->default_str("$HYBRIDTEST_GROUND_MOTIONS");
}

template <class Options>
CLI::App* add_study(CLI::App& studies, const std::string& name, const std::string& what,
                    const std::shared_ptr<Options>& options, int (*run)(const Options&), CommandAction& action) {
  CLI::App* study = studies.add_subcommand(name, what);
  study->add_option("--out", options->directory, "Directory for the results; replaces the files of an earlier study")
      ->required();
  study->add_option("--threads", options->threads, "Number of runs at the same time; the results do not depend on it")
      ->check(CLI::Range(1U, 1024U))
      ->capture_default_str();
  study->callback([options, run, &action] { action = [options, run] { return run(*options); }; });
  return study;
}

}  // namespace

void add_study_command(CLI::App& app, CommandAction& action) {
  CLI::App* studies = app.add_subcommand("study", "Run many simulated tests and compare them in tables and plots");
  studies->require_subcommand(1);

  const auto benchmark = std::make_shared<RthsOptions>();
  CLI::App* rths_benchmark = add_study(
      *studies, "rths_benchmark",
      "Every compensator on the virtual RTHS benchmark (Silva et al., 2020). Exit code 4: the harness does not\n"
      "reproduce the published values",
      benchmark, study_rths_benchmark, action);
  add_ground_motions(*rths_benchmark, benchmark->ground_motions);
  rths_benchmark->add_option("--plants", benchmark->plants, "Number of perturbed plants in addition to the nominal one")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  rths_benchmark->add_option("--seed", benchmark->seed, "Seed of the perturbed plants and of the sensor noise")
      ->capture_default_str();
  rths_benchmark->add_option("--compensator", benchmark->compensators,
                             "Run only these compensators; a name without +pi selects both variants");

  const auto recorded = std::make_shared<RecordedOptions>();
  CLI::App* rths_runs = studies->add_subcommand("rths_runs",
                                                "J1 to J9 of runs of launch/scenarios/rths_benchmark, beside the study "
                                                "in process at the same rate. Exit code 3:\n"
                                                "a run ended early");
  rths_runs->add_option("run", recorded->runs, "Run directories")->required()->check(CLI::ExistingDirectory);
  add_ground_motions(*rths_runs, recorded->ground_motions);
  rths_runs->add_option("--csv", recorded->csv, "Also writes the figures to this file");
  rths_runs->callback([recorded, &action] { action = [recorded] { return study_recorded_runs(*recorded); }; });

  const auto founding_study = std::make_shared<FoundingOptions>();
  add_study(*studies, "founding_study",
            "The compensation methods of the founding study, on its two-storey test with two actuators", founding_study,
            study_founding_study, action)
      ->add_option("--scenarios", founding_study->scenarios, "Directory with the scenarios of the study")
      ->capture_default_str();

  add_study(*studies, "compensators", "Frequency response, noise gain and stability limit of every compensator",
            std::make_shared<StudyOptions>(), study_compensators, action);
}

}  // namespace hybridtest
