#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <fstream>
#include <map>

#include "core/child_process.hpp"
#include "core/config_error.hpp"
#include "diagnosis/runs/diagnose_run.hpp"
#include "launch/check_lines.hpp"
#include "launch/commands.hpp"
#include "launch/diagnosis_progress.hpp"
#include "launch/finish_run.hpp"
#include "launch/live_page.hpp"
#include "launch/remote_hosts.hpp"
#include "launch/resumed_run.hpp"
#include "launch/run_monitor.hpp"
#include "runtime/executor.hpp"
#include "runtime/network_options.hpp"
#include "runtime/participant.hpp"
#include "runtime/participant_process.hpp"
#include "runtime/progress.hpp"
#include "runtime/resume.hpp"
#include "runtime/run_directory.hpp"
#include "scenario/scenario.hpp"
#include "transport/fast_dds/credentials.hpp"
#include "transport/fast_dds/fast_dds_transport.hpp"

namespace hybridtest {
namespace {

struct RunOptions {
  std::filesystem::path scenario_file;
  std::vector<std::string> overrides;
  std::filesystem::path directory;
  std::filesystem::path resumed;  // run directory of a test whose coordinator died
  bool diagnose = false;
  bool no_report = false;
  bool even_if_unstable = false;
  bool watch = false;
  bool allow_control = false;
  std::vector<std::string> remote;
  std::filesystem::path hosts_file;
  NetworkOptions network;
  std::filesystem::path credentials;
};

void check_remote(const RunOptions& options, const Scenario& scenario) {
  for (const std::string& id : options.remote) {
    if (scenario.find(id) == nullptr)
      throw ConfigError{"--remote " + id + ": the scenario has no substructure of this id"};
  }
}

/// Those of the host file, ready to be started.
std::vector<RemoteParticipant> prepare_remote(const RunOptions& options, const Scenario& scenario,
                                              const std::vector<RemoteHost>& hosts) {
  const std::string run_name = default_run_directory(scenario.name).filename().string();
  std::vector<RemoteParticipant> remote;
  for (const RemoteHost& host : hosts) {
    fmt::print(stderr, "{}: preparing {}\n", host.id, host.destination);
    remote.emplace_back(host, run_name, options.directory);
    remote.back().prepare(scenario, options.network.network_file());
  }
  return remote;
}

/// --credentials names the folder of folders here.
std::filesystem::path credentials_of(const RunOptions& options, std::string_view id) {
  return options.credentials / id;
}

/// Before anything is written: the credentials of every process that is started here.
void require_credentials(const RunOptions& options, const Scenario& scenario) {
  if (options.credentials.empty()) return;
  fast_dds::require_own_credentials(credentials_of(options, kCoordinatorId), scenario.name, kCoordinatorId);
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (std::ranges::find(options.remote, substructure.id) != options.remote.end()) continue;
    fast_dds::require_own_credentials(credentials_of(options, substructure.id), scenario.name, substructure.id);
  }
}

/// @param started   the ids of those to start here; the coordinator first.
std::vector<std::unique_ptr<ChildProcess>> start_processes(const RunOptions& options, const Scenario& scenario,
                                                           const std::vector<std::string>& started,
                                                           const std::vector<RemoteParticipant>& remote) {
  const std::filesystem::path programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const bool resumes = !options.resumed.empty();
  std::vector<std::string> shared{"--quiet"};
  if (resumes) {
    shared.insert(shared.end(), {"--resume", options.resumed.string()});
  } else {
    shared.insert(shared.end(), {"--scenario", options.scenario_file.string(), "--out", options.directory.string()});
  }
  for (const std::string& value : options.overrides) shared.insert(shared.end(), {"--set", value});

  std::vector<std::unique_ptr<ChildProcess>> children;
  for (const std::string& id : started) {
    const SubstructureScenario* substructure = scenario.find(id);
    const Role role = substructure == nullptr ? Role::coordinator : substructure->role;
    std::vector<std::string> arguments = shared;
    NetworkOptions network = options.network;
    if (!network.credentials().empty()) network.set_credentials(credentials_of(options, id));
    for (const std::string& value : network.arguments()) arguments.push_back(value);
    if (role != Role::coordinator) arguments.insert(arguments.end(), {"--id", id});
    // The log of the process that died stays.
    const std::string log = id + (resumes ? "_resumed.log" : ".log");
    children.push_back(std::make_unique<ChildProcess>(
        id, ChildStart{.program = programs / name(role), .arguments = arguments, .log_file = options.directory / log}));
  }
  NetworkOptions elsewhere = options.network;
  elsewhere.set_credentials({});  // each host has its own
  for (const RemoteParticipant& one : remote) {
    children.push_back(one.start(scenario, elsewhere.arguments_but_profile()));
  }
  return children;
}

std::vector<std::string> local_processes(const RunOptions& options, const Scenario& scenario) {
  std::vector<std::string> local{std::string{kCoordinatorId}};
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (std::ranges::find(options.remote, substructure.id) == options.remote.end()) local.push_back(substructure.id);
  }
  return local;
}

/// What the operator types when the coordinator has died.
std::string resume_command(const RunOptions& options) {
  std::string text = "hybridtest run --resume " + options.directory.string();
  for (const std::string& id : options.remote) text += " --remote " + id;
  NetworkOptions network = options.network;
  if (options.remote.empty()) network.set_loopback_only(false);  // is set again
  network.set_credentials(options.credentials);
  for (const std::string& value : network.arguments()) text += " " + value;
  return text;
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

/// Adds those of the host file to `options.remote`.
std::vector<RemoteHost> read_hosts(RunOptions& options, const Scenario& scenario) {
  if (options.hosts_file.empty()) return {};
  std::vector<RemoteHost> hosts = read_remote_hosts(options.hosts_file, scenario);
  for (const RemoteHost& host : hosts) {
    options.remote.push_back(host.id);
    const bool has_credentials = std::ranges::find(host.arguments, "--credentials") != host.arguments.end();
    if (has_credentials == options.network.credentials().empty()) {
      throw ConfigError{fmt::format(
          "{}: {} in {}: either all participants have credentials or none; each host has its own folder of them, as "
          "`arguments: [--credentials, FOLDER]`",
          host.id, has_credentials ? "has --credentials" : "has no --credentials", options.hosts_file.string())};
    }
  }
  return hosts;
}

/// The coordinator could not take the place of the one that died.
bool was_not_resumed(const std::vector<ProcessEnd>& ends) {
  const auto end = std::ranges::find(ends, kCoordinatorId, &ProcessEnd::participant);
  return end != ends.end() && end->before_start && end->exit_code == kExitConfiguration;
}

/// A new test: its directory is prepared.
void prepare(RunOptions& options, const Scenario& scenario) {
  if (options.diagnose) require_models(scenario);
  require_stable_test(scenario, options.even_if_unstable);
  say_nominal_inputs(scenario);
  if (options.directory.empty()) options.directory = default_run_directory(scenario.name);
  require_new_run(options.directory, kCoordinatorId);
  prepare_run_directory(options.directory, scenario);
}

int run(RunOptions options) {
  catch_stop_signals();
  const bool resumes = !options.resumed.empty();
  if (resumes) {
    options.directory = options.resumed;
    options.scenario_file = options.resumed / "scenario.yaml";
  } else if (options.scenario_file.empty()) {
    throw ConfigError{"run: FILE is required, or --resume RUN"};
  }
  const Scenario scenario = read_scenario(options.scenario_file, options.overrides);
  require_distributable(scenario);
  check_remote(options, scenario);
  const std::vector<RemoteHost> hosts = read_hosts(options, scenario);
  // This process looks on, and stops the test, as the coordinator may.
  options.credentials = options.network.credentials();
  require_credentials(options, scenario);
  if (!options.credentials.empty()) options.network.set_credentials(credentials_of(options, kCoordinatorId));
  fast_dds::require_usable(options.network.settings(kCoordinatorId));
  if (options.remote.empty() && options.network.is_unspecified()) options.network.set_loopback_only(true);
  std::vector<std::string> started = local_processes(options, scenario);
  if (resumes) {
    require_resumable(options.directory, scenario);
    started = processes_to_restart(scenario, options.directory, options.network.settings(kCoordinatorId), started);
  } else {
    prepare(options, scenario);
  }
  std::vector<RemoteParticipant> remote;
  if (!resumes) remote = prepare_remote(options, scenario, hosts);
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
    RunMonitor monitor{scenario, *transport, start_processes(options, scenario, started, remote), progress,
                       resume_command(options)};
    if (resumes) monitor.leave_others_alone();
    std::map<std::string, std::string> hosts_by_id;
    for (const RemoteHost& host : hosts) hosts_by_id[host.id] = host.destination;
    monitor.set_hosts(std::move(hosts_by_id));
    run_until(
        monitor, transport->waker(), clock, [&] { return monitor.is_done(); }, [](Instant) {});
    known.processes = monitor.ends();
    known.events = monitor.telling_events();
    for (const auto& child : monitor.children()) {
      if (child->id() == kCoordinatorId) coordinator_exit = *child->exit_code();
      const auto end = std::ranges::find(known.processes, child->id(), &ProcessEnd::participant);
      if (end->is_cause() || *child->exit_code() == kExitInternal) print_log(*end, child->log_file());
    }
    if (monitor.was_succeeded()) {
      fmt::print(stderr, "the test went on under another `hybridtest run --resume`, which tells how it ended\n");
      return kExitEndedEarly;
    }
    if (monitor.leaves_a_waiting_test()) return kExitEndedEarly;
  }
  for (const RemoteParticipant& one : remote) {
    if (const std::string told = one.fetch(); !told.empty()) fmt::print(stderr, "{}\n", told);
  }
  if (resumes && was_not_resumed(known.processes)) {
    fmt::print(stderr, "the test was not resumed; who waits for it still waits\n");
    return kExitConfiguration;
  }
  if (resumes) await_closed_files(scenario, options.directory);
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
  auto* file = command->add_option("FILE", options->scenario_file, "Scenario file (YAML)");
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
  command
      ->add_option("--hosts", options->hosts_file,
                   "Host file (YAML): the substructures to start on other machines over ssh")
      ->check(CLI::ExistingFile);
  command
      ->add_option("--resume", options->resumed,
                   "Go on with the test of this run directory, whose coordinator died: FILE is not given then")
      ->excludes(file);
  options->network.add_to(*command);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace hybridtest
