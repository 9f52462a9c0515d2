#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "launch/doctor_checks.hpp"
#include "recording/run_file.hpp"
#include "runtime/executor.hpp"
#include "runtime/incarnation.hpp"
#include "runtime/network_options.hpp"
#include "runtime/participant_process.hpp"
#include "runtime/version.hpp"
#include "transport/fast_dds/fast_dds_transport.hpp"

namespace hybridtest {
namespace {

using Verdict = DoctorLine::Verdict;

struct DoctorOptions {
  std::filesystem::path scenario_file;
  std::vector<std::string> overrides;
  std::string id{kCoordinatorId};
  std::filesystem::path directory = "runs";
  double wait_s = 60.0;
  double measure_s = 5.0;
  bool as_json = false;
  NetworkOptions network;
};

struct DoctorReport {
  std::vector<DoctorLine> lines;
  std::vector<LinkMeasurement> links;

  void add(std::vector<DoctorLine> more) { std::ranges::move(more, std::back_inserter(lines)); }
};

const char* word(Verdict verdict) {
  switch (verdict) {
    case Verdict::good: return "ok";
    case Verdict::note: return "note";
    case Verdict::fix: return "FIX";
  }
  return "";
}

LinkCheckSettings check_settings(const DoctorOptions& options, const Scenario& scenario, const ProcessClock& clock) {
  LinkCheckSettings settings;
  settings.identity.id = options.id;
  settings.identity.role = Role::coordinator;
  if (const SubstructureScenario* own = scenario.find(options.id)) settings.identity.role = own->role;
  settings.identity.incarnation = draw_incarnation();
  settings.identity.scenario_digest = scenario.digest;
  settings.version = software_version();
  settings.wall_zero = from_seconds(clock.zero_unix_s());
  settings.period = from_seconds(std::max(0.001, step_period_s(scenario)));
  settings.commands = std::max(20, static_cast<int>(options.measure_s / to_seconds(settings.period)));
  settings.patience = from_seconds(options.wait_s);
  return settings;
}

/// Together with the doctors of the others, in a partition where no rig listens.
void check_links(const DoctorOptions& options, const Scenario& scenario, DoctorReport& report) {
  const ProcessClock clock;
  fast_dds::FastDdsSettings network = options.network.settings(options.id);
  if (options.id != kCoordinatorId) network.substructure_id = options.id;
  network.best_effort_coupling = true;  // counts what is lost, and not what is sent again
  const std::unique_ptr<Transport> transport =
      fast_dds::make_fast_dds_transport(network, scenario.name.substr(0, 56) + ".doctor");
  wake_on_stop(transport->waker());
  const LinkCheckSettings settings = check_settings(options, scenario, clock);
  const auto run_check = [&](Node& node, const std::function<bool()>& is_done) {
    run_until(
        node, transport->waker(), clock, [&] { return is_done() || stop_was_requested(); }, [](Instant) {});
  };
  if (const SubstructureScenario* own = scenario.find(options.id)) {
    LinkEcho echo{settings, scenario.index_of(*own), static_cast<Eigen::Index>(own->interface_names.size()),
                  *transport};
    run_check(echo, [&] { return echo.is_done(); });
    if (const LinkMeasurement* link = echo.measurement()) report.links.push_back(*link);
    report.add(judge_others(scenario, options.id, echo.greeting().heard()));
  } else {
    std::vector<ExpectedParticipant> expected;
    for (const SubstructureScenario& one : scenario.substructures) {
      expected.push_back({.id = one.id, .dofs = static_cast<Eigen::Index>(one.interface_names.size())});
    }
    LinkProbe probe{settings, expected, *transport};
    run_check(probe, [&] { return probe.is_done(); });
    report.links = probe.measurements();
    report.add(judge_others(scenario, options.id, probe.greeting().heard()));
  }
  for (const LinkMeasurement& link : report.links) report.add(judge_link(scenario, link));
}

nlohmann::ordered_json as_json(const DoctorOptions& options, const Scenario& scenario, const DoctorReport& report,
                               bool is_ready) {
  nlohmann::ordered_json json;
  json["test"] = scenario.name;
  json["participant"] = options.id;
  json["version"] = software_version();
  json["scenario_digest"] = hex(scenario.digest);
  json["ready"] = is_ready;
  json["checks"] = nlohmann::json::array();
  for (const DoctorLine& line : report.lines) {
    const char* verdict = line.verdict == Verdict::fix ? "fix" : word(line.verdict);
    json["checks"].push_back(
        {{"code", name(line.code)}, {"verdict", verdict}, {"text", line.text}, {"advice", line.advice}});
  }
  json["links"] = nlohmann::json::array();
  for (const LinkMeasurement& link : report.links) {
    json["links"].push_back({{"substructure", link.substructure.text()},
                             {"sent", link.sent},
                             {"answered", link.answered},
                             {"round_trip_s_min", link.round_trip_s_min},
                             {"round_trip_s_median", link.round_trip_s_median},
                             {"round_trip_s_p99", link.round_trip_s_p99},
                             {"clock_offset_s", link.clock_offset_s},
                             {"clock_uncertainty_s", link.clock_uncertainty_s}});
  }
  return json;
}

void print(const DoctorOptions& options, const Scenario& scenario, const DoctorReport& report) {
  fmt::print("{} as {}, version {}\n", scenario.name, options.id, software_version());
  for (const DoctorLine& line : report.lines) {
    fmt::print("{:<5}{:<14}{}\n", word(line.verdict), name(line.code), line.text);
    if (!line.advice.empty()) fmt::print("{:<19}-> {}\n", "", line.advice);
  }
}

int examine(const DoctorOptions& options) {
  catch_stop_signals();
  const Scenario scenario = read_scenario(options.scenario_file, options.overrides);
  require_distributable(scenario);
  if (options.id != kCoordinatorId && scenario.find(options.id) == nullptr) {
    std::string known{kCoordinatorId};
    for (const SubstructureScenario& one : scenario.substructures) known += ", " + one.id;
    throw ConfigError{"--id " + options.id + ": the scenario has no such participant; expected one of " + known};
  }
  DoctorReport report;
  const auto profile = options.network.profile();
  if (profile) report.add(check_addresses(*profile, options.id));
  fmt::print(stderr, "{}: waiting up to {:.0f} s for {}; run `hybridtest doctor` on every host now\n", options.id,
             options.wait_s, options.id == kCoordinatorId ? "the substructures" : "the coordinator");
  const auto has_fix = [&report](DoctorCode code) {
    return std::ranges::any_of(
        report.lines, [&](const DoctorLine& line) { return line.verdict == Verdict::fix && line.code == code; });
  };
  if (!has_fix(DoctorCode::host_name)) check_links(options, scenario, report);
  if (profile && has_fix(DoctorCode::discovery)) report.add(check_connections(*profile, options.id));
  report.add({check_clock()});
  report.add(check_disk(scenario, options.id, options.directory));
  report.add({check_privileges(scenario, options.id)});
  const bool is_ready =
      std::ranges::none_of(report.lines, [](const DoctorLine& line) { return line.verdict == Verdict::fix; });
  if (options.as_json) {
    fmt::print("{}\n", as_json(options, scenario, report, is_ready).dump(2));
  } else {
    print(options, scenario, report);
    fmt::print("{}\n", is_ready ? "ready" : "NOT ready: see the lines that begin with FIX, and docs/across_hosts.md");
  }
  return is_ready ? kExitCompleted : kExitConfiguration;
}

}  // namespace

void add_doctor_command(CLI::App& app, CommandAction& action) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command = app.add_subcommand(
      "doctor", "Check that this host is ready for a test: run it on every host of the test at the same time");
  command->add_option("FILE", options->scenario_file, "Scenario file (YAML)")->required();
  command->add_option("--id", options->id, "Which participant this host is")->capture_default_str();
  command->add_option("--set", options->overrides, "Override one value of the scenario: key.path=value; repeatable");
  command->add_option("--out", options->directory, "Where the run will be recorded")->capture_default_str();
  command->add_option("--wait", options->wait_s, "[s] For the doctors of the other hosts")
      ->check(CLI::Range(1.0, 3600.0))
      ->capture_default_str();
  command->add_option("--measure", options->measure_s, "[s] How long the links are measured")
      ->check(CLI::Range(0.1, 600.0))
      ->capture_default_str();
  command->add_flag("--json", options->as_json, "Print JSON");
  options->network.add_to(*command);
  command->callback([options, &action] { action = [options] { return examine(*options); }; });
}

}  // namespace hybridtest
