#include <fmt/format.h>

#include <fstream>

#include "core/config_error.hpp"
#include "diagnosis/runs/diagnose_run.hpp"
#include "launch/child_process.hpp"
#include "launch/commands.hpp"
#include "launch/diagnosis_progress.hpp"
#include "launch/finish_run.hpp"
#include "launch/progress.hpp"
#include "launch/run_monitor.hpp"
#include "runtime/executor.hpp"
#include "runtime/network_options.hpp"
#include "runtime/participant.hpp"
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
  std::vector<std::string> shared{"--scenario", options.scenario_file.string(), "--out", options.directory.string()};
  for (const std::string& value : options.overrides) shared.insert(shared.end(), {"--set", value});
  for (const std::string& value : options.network.arguments()) shared.push_back(value);

  std::vector<std::unique_ptr<ChildProcess>> children;
  const auto start = [&](std::string_view id, Role role) {
    std::vector<std::string> arguments = shared;
    if (role != Role::coordinator) arguments.insert(arguments.end(), {"--id", std::string{id}});
    children.push_back(std::make_unique<ChildProcess>(std::string{id}, programs / name(role), arguments,
                                                      options.directory / (std::string{id} + ".log")));
  };
  start(kCoordinatorId, Role::coordinator);
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (std::ranges::find(options.remote, substructure.id) == options.remote.end()) {
      start(substructure.id, substructure.role);
    }
  }
  return children;
}

/// The log of a process that ended with an unexpected exit code.
void print_log(const ChildProcess& child) {
  std::ifstream log{child.log_file()};
  fmt::print(stderr, "{} ended with exit code {}; its log {}:\n", child.id(), *child.exit_code(),
             child.log_file().string());
  for (std::string line; std::getline(log, line);) fmt::print(stderr, "  {}\n", line);
}

int run(RunOptions options) {
  const Scenario scenario = read_scenario(options.scenario_file, options.overrides);
  check_remote(options, scenario);
  if (options.diagnose) require_models(scenario);
  if (options.directory.empty()) options.directory = default_run_directory(scenario.name);
  require_new_run(options.directory, kCoordinatorId);
  prepare_run_directory(options.directory, scenario);
  if (options.remote.empty()) options.network.set_loopback_only(true);
  fmt::print(stderr, "{}: {} steps of {} s, recordings in {}\n", scenario.name, scenario.time.last_step,
             scenario.time.step_s, options.directory.string());

  const ProcessClock clock;
  const auto transport = fast_dds::make_fast_dds_transport(options.network.settings(), scenario.name);
  stop_on_signals(transport->waker());
  int coordinator_exit = kExitInternal;
  {
    Progress progress{scenario, stderr};
    RunMonitor monitor{scenario, *transport, start_processes(options, scenario), progress};
    run_until(
        monitor, transport->waker(), clock, [&] { return monitor.is_done(); }, [](Instant) {});
    for (const auto& child : monitor.children()) {
      if (child->id() == kCoordinatorId) coordinator_exit = *child->exit_code();
    }
    for (const auto& child : monitor.children()) {
      if (*child->exit_code() != coordinator_exit && *child->exit_code() != kExitCompleted) print_log(*child);
    }
    if (coordinator_exit == kExitConfiguration || coordinator_exit == kExitInternal) {
      print_log(*monitor.children().front());
    }
  }
  const int exit_code = finish_run(options.directory, coordinator_exit);
  if (options.diagnose) show_diagnosis(scenario, options.directory);
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
  command->add_option("--set", options->overrides, "Override one value of the scenario: key.path=value; repeatable");
  command->add_option("--remote", options->remote,
                      "Id of a substructure that you start on another machine; repeatable");
  options->network.add_to(*command);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace hybridtest
