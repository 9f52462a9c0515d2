#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/event_text.hpp"
#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "runtime/executor.hpp"
#include "runtime/network_options.hpp"
#include "runtime/operator_control.hpp"

namespace hybridtest {
namespace {

struct ControlOptions {
  std::string test_name;
  NetworkOptions network;
};

std::string list(const std::vector<std::string>& ids) { return fmt::format("{}", fmt::join(ids, ", ")); }

int send_control(const ControlOptions& options, ControlVerb verb) {
  constexpr Duration kDiscovery = std::chrono::seconds{5};     // for the first participant
  constexpr Duration kMore = std::chrono::milliseconds{1500};  // for further ones, after the last
  constexpr Duration kPatience = std::chrono::seconds{15};
  const ProcessClock clock;
  OperatorControl paths{options.network, options.test_name, verb};
  const auto is_over = [&] {
    const Instant now = clock.now();
    const OperatorRequest& path = paths.best();
    if (path.found().empty()) return now.time_since_epoch() > kDiscovery;
    if (path.is_refused()) return true;
    if (now - path.last_discovery() > kPatience) return true;
    const bool knows_all = !path.stops() || path.is_complete() || now - path.last_discovery() > kMore;
    return knows_all && path.is_obeyed();
  };
  run_until(paths, paths.waker(), clock, is_over, [](Instant) {});

  const OperatorRequest& path = paths.best();
  if (path.found().empty()) {
    fmt::print(stderr, "{}: no participant of this test was found; check the test name, --domain and --peer\n",
               options.test_name);
    return kExitConfiguration;
  }
  if (path.is_refused()) {
    Event refused;
    refused.code = EventCode::pause_refused;
    fmt::print(stderr, "{}: {}\n", options.test_name, describe(refused));
    return kExitConfiguration;
  }
  std::vector<std::string> obeyed;
  std::vector<std::string> not_obeyed;
  for (const FoundParticipant& one : path.found()) {
    if (one.obeyed_after) {
      obeyed.push_back(fmt::format("{} ({:.0f} ms)", one.id, 1e3 * to_seconds(*one.obeyed_after)));
    } else {
      not_obeyed.push_back(one.id);
    }
  }
  if (path.is_obeyed()) {
    fmt::print("{}: done; obeyed (time since found): {}\n", options.test_name, list(obeyed));
  } else {
    fmt::print(stderr, "{}: obeyed: {}; did NOT obey within 15 s: {}; {}\n", options.test_name,
               obeyed.empty() ? "nobody" : list(obeyed), list(not_obeyed),
               verb == ControlVerb::stop ? "use emergency-stop, or stop the rigs by hand" : "stop the rigs by hand");
  }
  const std::vector<std::string> missing = path.stops() ? path.missing() : std::vector<std::string>{};
  if (!missing.empty()) {
    fmt::print(stderr, "{}: NOT found: {}; if a process hangs or its network is down, stop its rig by hand\n",
               options.test_name, list(missing));
  }
  return path.is_obeyed() && missing.empty() ? kExitCompleted : kExitEndedEarly;
}

void add(CLI::App& app, CommandAction& action, const std::string& command_name, const std::string& what,
         ControlVerb verb) {
  auto options = std::make_shared<ControlOptions>();
  CLI::App* command = app.add_subcommand(command_name, what);
  command->add_option("NAME", options->test_name, "Name of the test: the key `name` of its scenario")->required();
  options->network.add_to(*command);
  command->callback([options, &action, verb] { action = [options, verb] { return send_control(*options, verb); }; });
}

}  // namespace

void add_control_commands(CLI::App& app, CommandAction& action) {
  add(app, action, "stop", "Stop a running test safely: every rig comes to rest, all records are closed",
      ControlVerb::stop);
  add(app, action, "emergency-stop", "Stop the motion of every rig of a running test at once",
      ControlVerb::emergency_stop);
  add(app, action, "pause", "Pause a running test: the rigs hold their position", ControlVerb::pause);
  add(app, action, "resume", "Continue a paused test; clear interlocks that wait for the operator",
      ControlVerb::resume);
}

}  // namespace hybridtest
