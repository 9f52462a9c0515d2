#include <fmt/format.h>
#include <fmt/ranges.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "core/child_process.hpp"
#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "recording/run_file.hpp"
#include "runtime/executor.hpp"
#include "runtime/run_directory.hpp"
#include "scenario/scenario.hpp"
#include "validation/studies/output_file.hpp"
#include "validation/studies/parallel_runs.hpp"
#include "validation/studies/study_progress.hpp"
#include "validation/sweep/sweep_page.hpp"
#include "validation/sweep/sweep_plan.hpp"
#include "validation/sweep/sweep_table.hpp"

namespace hybridtest {
namespace {

namespace fs = std::filesystem;

struct SweepOptions {
  fs::path source;  // a scenario, or the folder of a sweep that was begun
  std::vector<std::string> varied;
  std::vector<std::string> overrides;
  std::string seeds = "1";
  unsigned jobs = usable_threads();
  fs::path directory;
  bool keeps_runs = false;
  bool only_prepares = false;
  std::size_t only_case = 0;
  std::vector<std::string> exceedances;
};

std::string digest_of(const fs::path& file, const std::vector<std::string>& overrides) {
  return hex(read_scenario(file, overrides).digest);
}

/// What the case changes in the scenario.
std::vector<std::string> overrides_of(const SweepPlan& plan, const SweepCase& one) {
  std::vector<std::string> overrides;
  const std::vector<std::string> arguments = plan.arguments(one, "run");
  for (std::size_t k = 0; k + 1 < arguments.size(); ++k) {
    if (arguments[k] == "--set") overrides.push_back(arguments[k + 1]);
  }
  return overrides;
}

/// Each value by itself, so that a wrong one is told before the first run.
void check_values(const SweepPlan& plan) {
  std::set<std::vector<std::string>> read;
  const SweepCase first = plan.case_at(1);
  const Scenario scenario = read_scenario(plan.scenario_file, overrides_of(plan, first));
  for (const Varied& one : plan.varied) {
    const std::optional<std::string> site = site_of_latency(one.key);
    if (site && scenario.find(*site) == nullptr) {
      throw ConfigError{"--vary " + one.key + ": the scenario has no substructure '" + *site + "'"};
    }
  }
  for (std::size_t i = 0; i < plan.varied.size(); ++i) {
    for (const std::string& value : plan.varied[i].values) {
      SweepCase one = first;
      one.values[i] = value == kSeedValue ? std::to_string(one.seed) : value;
      const std::vector<std::string> overrides = overrides_of(plan, one);
      if (read.insert(overrides).second) static_cast<void>(read_scenario(plan.scenario_file, overrides));
    }
  }
}

SweepPlan plan_of(const SweepOptions& options) {
  SweepPlan plan;
  plan.scenario_file = fs::absolute(options.source);
  plan.overrides = options.overrides;
  for (const std::string& text : options.varied) plan.varied.push_back(read_varied(text));
  std::tie(plan.first_seed, plan.last_seed) = read_seeds(options.seeds);
  plan.keeps_runs = options.keeps_runs;
  plan.scenario_digest = digest_of(plan.scenario_file, {});
  check_values(plan);
  return plan;
}

fs::path own_program() { return fs::read_symlink("/proc/self/exe"); }

/// For a shell: between single quotes.
std::string shell_word(const std::string& text) {
  std::string word = "'";
  for (const char letter : text) word += letter == '\'' ? std::string{"'\\''"} : std::string{letter};
  return word + "'";
}

/// The list of work for another engine: one line, one case.
void write_jobs(const SweepPlan& plan, const SweepFiles& files) {
  std::string text;
  for (std::size_t number = 1; number <= plan.case_count(); ++number) {
    text += fmt::format("{} sweep {} --case {}\n", shell_word(own_program().string()),
                        shell_word(fs::absolute(files.directory).string()), number);
  }
  write_output_file(files.jobs(), text);
}

/// Makes the folder, or finds it as this plan has left it.
void prepare(const SweepPlan& plan, const SweepFiles& files) {
  if (fs::exists(files.plan())) {
    if (read_plan(files) == plan) return;
    throw ConfigError{files.directory.string() +
                      ": holds a sweep with another scenario, other values or other seeds; choose another --out"};
  }
  write_plan(plan, files);
  write_jobs(plan, files);
}

/// In place of a summary, for a case that did not run.
void write_failure(const ChildProcess& child, const fs::path& file) {
  const nlohmann::ordered_json failure{
      {"exit_code", *child.exit_code()}, {"stop_reason", "not_run"}, {"why", child.last_words()}};
  write_output_file(file, failure.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

/// Runs one case in a process of its own. Its result is there afterwards, or it was interrupted.
void run_case(const SweepPlan& plan, const SweepFiles& files, std::size_t number) {
  const fs::path run = files.run(number);
  fs::remove_all(run);  // of a case that was interrupted
  ChildProcess child{std::to_string(number), ChildStart{.program = own_program(),
                                                        .arguments = plan.arguments(plan.case_at(number), run),
                                                        .log_file = files.log(number),
                                                        .is_killed_with_parent = true}};
  while (!child.wait_for_end(std::chrono::milliseconds{50})) {
    if (stop_was_requested()) child.kill();
  }
  if (stop_was_requested()) {
    fs::remove_all(run);
    return;
  }
  const fs::path summary = run / "summary.json";
  const fs::path finished = files.result(number).string() + ".part";
  if (fs::exists(summary)) {
    fs::copy_file(summary, finished, fs::copy_options::overwrite_existing);
  } else {
    write_failure(child, finished);
  }
  if (!plan.keeps_runs) fs::remove_all(run);
  if (*child.exit_code() == kExitCompleted && !plan.keeps_runs) fs::remove(files.log(number));
  fs::rename(finished, files.result(number));
}

void run_cases(const SweepPlan& plan, const SweepFiles& files, unsigned jobs) {
  std::vector<std::size_t> waiting;
  for (std::size_t number = 1; number <= plan.case_count(); ++number) {
    if (!fs::exists(files.result(number))) waiting.push_back(number);
  }
  fmt::print(stderr, "{} cases in {}, {} to run\n", plan.case_count(), files.directory.string(), waiting.size());
  StudyProgress progress{waiting.size(), stderr};
  run_in_parallel(waiting.size(), jobs, [&](std::size_t i) {
    if (stop_was_requested()) return;
    run_case(plan, files, waiting[i]);
    if (!stop_was_requested()) progress.completed(fmt::format("case {}", waiting[i]));
  });
}

/// @return the exit code: whether every case is done.
int collect(const SweepPlan& plan, const SweepFiles& files, const std::vector<std::string>& exceedances) {
  const SweepTable table = read_results(plan, files);
  if (table.done == 0) {
    fmt::print(stderr, "no case is done; the same command goes on\n");
    return kExitEndedEarly;
  }
  write_output_file(files.table(), to_csv(table));
  std::vector<Exceedance> read;
  for (const std::string& text : exceedances) read.push_back(read_exceedance(text));
  write_output_file(files.page(), sweep_page(plan, table, read));
  std::size_t completed = 0;
  const std::size_t column = table.column("exit_code");
  for (const auto& row : table.rows) completed += row[column] == "0" ? 1U : 0U;
  fmt::print("{} of {} cases done, {} completed their test\n  table  {}\n  page   {}\n", table.done, table.rows.size(),
             completed, files.table().string(), files.page().string());
  if (table.done == table.rows.size()) return kExitCompleted;
  fmt::print(stderr, "{} cases are not done; the same command goes on with them\n", table.rows.size() - table.done);
  return kExitEndedEarly;
}

int sweep(const SweepOptions& options) {
  catch_stop_signals();
  SweepFiles files{options.directory};
  SweepPlan plan;
  if (fs::is_directory(options.source)) {
    files.directory = options.source;
    plan = read_plan(files);
    if (!options.varied.empty() || !options.overrides.empty() || !options.directory.empty()) {
      throw ConfigError{options.source.string() +
                        " is the folder of a sweep, whose plan stays; leave --vary, --set and --out"};
    }
    if (digest_of(plan.scenario_file, {}) != plan.scenario_digest) {
      throw ConfigError{plan.scenario_file.string() + ": has changed since the sweep began; begin another sweep"};
    }
  } else {
    plan = plan_of(options);
    if (files.directory.empty()) files.directory = default_run_directory(plan.scenario_file.stem().string() + "_sweep");
    prepare(plan, files);
  }
  if (options.only_case > 0) {
    if (options.only_case > plan.case_count()) {
      throw ConfigError{fmt::format("--case {}: the sweep has {} cases", options.only_case, plan.case_count())};
    }
    if (!fs::exists(files.result(options.only_case))) run_case(plan, files, options.only_case);
    return stop_was_requested() ? kExitEndedEarly : kExitCompleted;
  }
  if (options.only_prepares) {
    fmt::print("{} cases, one line each in {}\n", plan.case_count(), files.jobs().string());
    return kExitCompleted;
  }
  run_cases(plan, files, options.jobs);
  return collect(plan, files, options.exceedances);
}

}  // namespace

void add_sweep_command(CLI::App& app, CommandAction& action) {
  auto options = std::make_shared<SweepOptions>();
  CLI::App* command = app.add_subcommand(
      "sweep", "Simulate a test many times: every combination of values and seeds, as one table and page");
  command->add_option("FILE", options->source, "Scenario file (YAML), or the folder of a sweep to go on with")
      ->required();
  command->add_option("--vary", options->varied,
                      "key.path=a,b,c or key.path=low..high/count[/log]; repeatable. A value @seed is the seed of the "
                      "case. Also latency_us, latency_spread, site_latency_us[ID], jitter_us, loss, duplication, "
                      "reordering of the network");
  command->add_option("--seeds", options->seeds, "first..last: each case is run with every seed")
      ->capture_default_str();
  command->add_option("--set", options->overrides, "Override one value in every case: key.path=value; repeatable");
  command->add_option("--jobs", options->jobs, "Cases at the same time; the results do not depend on it")
      ->check(CLI::Range(1U, 1024U))
      ->capture_default_str();
  command->add_option("--out", options->directory, "Folder of the sweep; one that was interrupted goes on")
      ->default_str("runs/<name>_sweep_<time>");
  command->add_option("--exceed", options->exceedances,
                      "column=limit: curves of the share of cases above it, with a column of the table; repeatable");
  command->add_flag("--keep-runs", options->keeps_runs, "Keep the run directory of each case, not its summary alone");
  command->add_flag("--prepare", options->only_prepares, "Only write the plan and jobs.txt, for workers elsewhere");
  command->add_option("--case", options->only_case, "Run this case of a prepared sweep alone");
  command->callback([options, &action] { action = [options] { return sweep(*options); }; });
}

}  // namespace hybridtest
