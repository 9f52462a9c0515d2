#include "launch/resumed_run.hpp"

#include <algorithm>
#include <map>

#include "core/config_error.hpp"
#include "recording/error.hpp"
#include "recording/run_file_reader.hpp"
#include "runtime/executor.hpp"
#include "runtime/run_directory.hpp"
#include "transport/fast_dds/fast_dds_transport.hpp"

namespace hybridtest {
namespace {

constexpr Duration kResumePoll = std::chrono::milliseconds{50};
/// Longer than discovery takes on a busy machine.
constexpr Duration kResumeListen = std::chrono::seconds{3};
constexpr Duration kFilesClose = std::chrono::seconds{10};

bool is_gone_state(LifecycleState state) {
  return state == LifecycleState::finished || state == LifecycleState::refused || state == LifecycleState::lost;
}

/// Everyone who is heard, by id.
std::map<std::string, LifecycleState> hear_everyone(const Scenario& scenario,
                                                    const fast_dds::FastDdsSettings& network) {
  const auto transport = fast_dds::make_fast_dds_transport(network, scenario.name);
  const auto statuses = transport->status_inbox();
  std::map<std::string, LifecycleState> heard;
  const ProcessClock clock;
  // A coordinator that died is heard as running until its lease is over; one that lives sends its status meanwhile.
  const Duration limit = scenario.timeouts.liveliness_lease + kResumeListen;
  while (clock.now().time_since_epoch() < limit && !stop_was_requested()) {
    for (ParticipantStatus status; statuses->take(status);) heard[status.id.text()] = status.state;
    const bool has_coordinator = heard.contains(std::string{kCoordinatorId});
    const bool has_all = std::ranges::all_of(scenario.substructures, [&](const SubstructureScenario& one) {
      const auto found = heard.find(one.id);
      return found != heard.end() && found->second == LifecycleState::waiting;
    });
    if (has_all && !has_coordinator) break;
    rest_until(clock, clock.now() + kResumePoll);
  }
  return heard;
}

bool was_closed(const std::filesystem::path& file) {
  try {
    return RunFileReader{file}.counters().closed_cleanly;
  } catch (const RecordingError&) {
    return false;
  }
}

std::string why_gone(const std::string& id, const std::filesystem::path& run_directory) {
  if (was_closed(run_file(run_directory, id))) {
    return "the site '" + id +
           "' has ended the test safely: it waited for timeouts.resume_s, or was stopped. Its rig is at rest; start a "
           "new "
           "test";
  }
  return "the site '" + id +
         "' is not heard: it died, or the network to it is down. A site cannot be restarted in the middle of a test: "
         "what its specimen has gone through cannot be restored. Start a new test";
}

}  // namespace

std::vector<std::string> processes_to_restart(const Scenario& scenario, const std::filesystem::path& run_directory,
                                              fast_dds::FastDdsSettings network,
                                              const std::vector<std::string>& local) {
  network.is_observer = true;
  network.lease = network.heartbeat_deadline = scenario.timeouts.liveliness_lease;
  const std::map<std::string, LifecycleState> heard = hear_everyone(scenario, network);
  const auto is_there = [&](const std::string& id) {
    const auto found = heard.find(id);
    return found != heard.end() && !is_gone_state(found->second);
  };
  const std::string begin = "--resume " + run_directory.string() + ": ";
  if (is_there(std::string{kCoordinatorId})) {
    throw ConfigError{begin + "the coordinator of this test is still running; stop it with `hybridtest stop " +
                      scenario.name + "`, or wait until it is lost (timeouts.liveliness_lease_s)"};
  }
  std::vector<std::string> gone{std::string{kCoordinatorId}};
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (is_there(substructure.id)) continue;
    if (substructure.role == Role::experimental_site) {
      throw ConfigError{begin + why_gone(substructure.id, run_directory)};
    }
    // One on another machine is started there, with --resume.
    if (std::ranges::find(local, substructure.id) != local.end()) gone.push_back(substructure.id);
  }
  return gone;
}

void await_closed_files(const Scenario& scenario, const std::filesystem::path& run_directory) {
  const ProcessClock clock;
  const auto is_open = [&](const SubstructureScenario& one) {
    const std::filesystem::path file = run_file(run_directory, one.id);
    return std::filesystem::exists(file) && !was_closed(file);
  };
  while (clock.now().time_since_epoch() < kFilesClose && std::ranges::any_of(scenario.substructures, is_open)) {
    rest_until(clock, clock.now() + kResumePoll);
  }
}

}  // namespace hybridtest
