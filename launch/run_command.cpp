#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <fstream>

#include "core/child_process.hpp"
#include "core/config_error.hpp"
#include "diagnosis/runs/diagnose_run.hpp"
#include "launch/check_lines.hpp"
#include "launch/commands.hpp"
#include "launch/diagnosis_progress.hpp"
#include "launch/finish_run.hpp"
#include "launch/live_page.hpp"
#include "launch/run_monitor.hpp"
#include "runtime/executor.hpp"
#include "runtime/network_options.hpp"
#include "runtime/participant.hpp"
#include "runtime/progress.hpp"
#include "runtime/run_directory.hpp"
#include "scenario/scenario.hpp"
#include "transport/fast_dds/fast_dds_transport.hpp"

namespace hybridtest {
namespace {

struct RunOptions {
  std::filesystem::path scenario_file;
  std::vector<std::string> overrides;
  std::filesystem::path directory;
  bool diagnose = false;
  bool no_report = false;
  bool even_if_unstable = false;
  bool watch = false;
  bool allow_control = false;
  std::vector<std::string> remote;
  NetworkOptions network;
};

void check_remote(const RunOptions& options, const Scenario& scenario) {
  for (const std::string& id : options.remote) {
    if (scenario.find(id) == nullptr)
      throw ConfigError{"--remote " + id + ": the scenario has no substructure of this id"};
  }
}

std::vector<std::unique_ptr<ChildProcess>> start_processes(const RunOptions& options, const Scenario& scenario) {
  const std::filesystem::path programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  std::vector<std::string> shared{"--scenario", options.scenario_file.string(), "--out", options.directory.string(),
                                  "--quiet"};
  for (const std::string& value : options.overrides) shared.insert(shared.end(), {"--set", value});
  for (const std::string& value : options.network.arguments()) shared.push_back(value);

  std::vector<std::unique_ptr<ChildProcess>> children;
  const auto start = [&](std::string_view id, Role role) {
    std::vector<std::string> arguments = shared;
    if (role != Role::coordinator) arguments.insert(arguments.end(), {"--id", std::string{id}});
    children.push_back(std::make_unique<ChildProcess>(
        std::string{id}, ChildStart{.program = programs / name(role),
                                    .arguments = arguments,
                                    .log_file = options.directory / (std::string{id} + ".log")}));
  };
  start(kCoordinatorId, Role::coordinator);
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (std::ranges::find(options.remote, substructure.id) == options.remote.end()) {
      start(substructure.id, substructure.role);
    }
  }
  return children;
}

/// The end of the log of a process that failed by itself.
void print_log(const ProcessEnd& end, const std::filesystem::path& log_file) {
  constexpr std::size_t kLines = 20;
  std::deque<std::string> lines;
  std::ifstream log{log_file};
  for (std::string line; std::getline(log, line);) {
    lines.push_back(line);
    if (lines.size() > kLines) lines.pop_front();
  }
  fmt::print(stderr, "{}: {}; the end of its log {}:\n", end.participant, end.text(), log_file.string());
  for (const std::string& line : lines) fmt::print(stderr, "  {}\n", line);
}

int run(RunOptions options) {
  catch_stop_signals();
  const Scenario scenario = read_scenario(options.scenario_file, options.overrides);
  check_remote(options, scenario);
  if (options.diagnose) require_models(scenario);
  require_stable_test(scenario, options.even_if_unstable);
  fast_dds::require_usable(options.network.settings());
  if (options.directory.empty()) options.directory = default_run_directory(scenario.name);
  require_new_run(options.directory, kCoordinatorId);
  prepare_run_directory(options.directory, scenario);
  if (options.remote.empty()) options.network.set_loopback_only(true);
  std::optional<LivePage> page;
  if (options.watch)
    page.emplace(start_live_page(scenario.name, options.directory, options.network, options.allow_control));
  fmt::print(stderr, "{}: {} steps of {} s, recordings in {}\n", scenario.name, scenario.time.last_step,
             scenario.time.step_s, options.directory.string());

  const ProcessClock clock;
  fast_dds::FastDdsSettings network = options.network.settings();
  network.is_observer = true;
  const auto transport = fast_dds::make_fast_dds_transport(network, scenario.name);
  wake_on_stop(transport->waker());
  int coordinator_exit = kExitInternal;
  SummaryInput known;
  known.test_name = scenario.name;
  {
    Progress progress{scenario, stderr};
    RunMonitor monitor{scenario, *transport, start_processes(options, scenario), progress};
    run_until(
        monitor, transport->waker(), clock, [&] { return monitor.is_done(); }, [](Instant) {});
    known.processes = monitor.ends();
    known.events = monitor.telling_events();
    for (const auto& child : monitor.children()) {
      if (child->id() == kCoordinatorId) coordinator_exit = *child->exit_code();
      const auto end = std::ranges::find(known.processes, child->id(), &ProcessEnd::participant);
      if (end->is_cause() || *child->exit_code() == kExitInternal) print_log(*end, child->log_file());
    }
  }
  write_process_ends(known.processes, options.directory);
  const int exit_code = finish_run(options.directory, coordinator_exit, known,
                                   options.no_report ? ReportWish::without : ReportWish::with);
  if (options.diagnose) show_diagnosis(scenario, options.directory);
  if (page) page->tell_end();
  return exit_code;
}

}  // namespace

void add_run_command(CLI::App& app, CommandAction& action) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run", "Run a test: start its processes on this machine, connected by DDS");
  command->add_option("FILE", options->scenario_file, "Scenario file (YAML)")->required();
  command->add_option("--out", options->directory, "Run directory to create")->default_str("runs/<name>_<time>");
  command->add_flag("--diagnose", options->diagnose,
                    "After the test, diagnose every site against the `model` beside its rig; results in RUN/diagnosis");
  command->add_flag("--no-report", options->no_report, "Do not write RUN/report.html");
  auto* watch = command->add_flag("--watch", options->watch, "Show the test in the browser; prints the address");
  command->add_flag("--allow-control", options->allow_control, "With --watch: pause, resume and stop from the page")
      ->needs(watch);
  command->add_flag("--even-if-unstable", options->even_if_unstable,
                    "Run a test that `check` calls unstable although a rig of it is not simulated");
  command->add_option("--set", options->overrides, "Override one value of the scenario: key.path=value; repeatable");
  command->add_option("--remote", options->remote,
                      "Id of a substructure that you start on another machine; repeatable");
  options->network.add_to(*command);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace hybridtest
