#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>

#include "launch/commands.hpp"
#include "runtime/executor.hpp"
#include "runtime/incarnation.hpp"
#include "runtime/network_options.hpp"
#include "runtime/participant.hpp"
#include "scenario/scenario.hpp"
#include "transport/fast_dds/fast_dds_transport.hpp"

namespace hybridtest {
namespace {

struct ControlOptions {
  std::string test_name;
  NetworkOptions network;
};

/// A participant that was found, and whether it obeyed.
struct Found {
  std::string id;
  Role role = Role::operator_tool;
  Instant discovered{};
  std::optional<Duration> obeyed_after{};  // from the discovery
};

/// Sends a control message on one network path, at once to each participant that it discovers, until all have obeyed.
/// `stop` and `emergency_stop` count as obeyed when a participant leaves the test; an emergency stop goes to the sites
/// directly and needs no coordinator. `pause` and `resume` count when the coordinator reports them.
class OperatorNode final : public Node {
 public:
  OperatorNode(ControlVerb verb, Transport& transport)
      : verb_{verb},
        incarnation_{draw_incarnation()},
        statuses_{transport.status_inbox()},
        events_{transport.event_inbox()},
        announcements_{transport.announcement_inbox()},
        control_{transport.control_outbox()} {}

  [[nodiscard]] Instant advance(Instant now) noexcept override {
    ParticipantStatus status;
    while (statuses_->take(status)) learn(status, now);
    Event event;
    while (events_->take(event)) {
      const bool answers = (verb_ == ControlVerb::pause && event.code == EventCode::test_paused) ||
                           (verb_ == ControlVerb::resume && event.code == EventCode::test_resumed);
      if (answers) note_obeyed(event.source.text(), now);
    }
    while (announcements_->take(announcement_)) is_announced_ = true;
    if (may_send(now) && now >= send_due_) {
      TestControl message;
      message.verb = verb_;
      message.sender = incarnation_;
      message.sender_role = Role::operator_tool;
      message.reason = verb_ == ControlVerb::emergency_stop ? StopReason::emergency_stop : StopReason::interrupted;
      control_->send(message);
      send_due_ = now + (stops() ? kRepeat : kRepeatQuestion);
    }
    return now + kPoll;
  }

  [[nodiscard]] const std::vector<Found>& found() const noexcept { return found_; }
  [[nodiscard]] Instant last_discovery() const noexcept { return last_discovery_; }
  /// Everyone who takes part has been found.
  [[nodiscard]] bool is_complete() const {
    if (test_is_over_) return true;
    if (!is_announced_ || !contains(std::string{kCoordinatorId})) return false;
    return std::ranges::all_of(announced(), [this](const auto& one) { return contains(one.id.text()); });
  }
  /// Those that the coordinator announced and that were not found.
  [[nodiscard]] std::vector<std::string> missing() const {
    std::vector<std::string> missing;
    // A coordinator that obeys brings to rest everyone whom it announced.
    if (test_is_over_ || coordinator_obeyed()) return missing;
    if (!contains(std::string{kCoordinatorId})) missing.emplace_back(kCoordinatorId);
    for (const auto& one : announced()) {
      if (!contains(one.id.text())) missing.push_back(one.id.text());
    }
    return missing;
  }
  /// Whoever has to obey has done so. For `pause` and `resume` that is the coordinator.
  [[nodiscard]] bool is_obeyed() const {
    if (stops()) return std::ranges::all_of(found_, [](const Found& one) { return one.obeyed_after.has_value(); });
    return coordinator_obeyed();
  }
  [[nodiscard]] bool stops() const noexcept {
    return verb_ == ControlVerb::stop || verb_ == ControlVerb::emergency_stop;
  }

 private:
  static constexpr Duration kPoll = std::chrono::milliseconds{5};
  static constexpr Duration kRepeat = std::chrono::milliseconds{20};
  /// The answer to `pause` and `resume` is an event, which this tool hears only when it has discovered its sender.
  static constexpr Duration kRepeatQuestion = std::chrono::milliseconds{300};

  [[nodiscard]] bool may_send(Instant now) const {
    if (stops()) return !found_.empty();
    return contains(std::string{kCoordinatorId}) && now - last_discovery_ >= kRepeatQuestion;
  }
  void learn(const ParticipantStatus& status, Instant now) {
    if (status.role == Role::operator_tool) return;
    const bool is_leaving = status.state == LifecycleState::stopping || status.state == LifecycleState::finished ||
                            status.state == LifecycleState::refused || status.state == LifecycleState::lost;
    const std::string id = status.id.text();
    if (!contains(id)) {
      // The last status of an earlier test of this name says nothing of a running one.
      if (found_.empty() && is_leaving && status.state != LifecycleState::stopping) return;
      found_.push_back({id, status.role, now, {}});
      last_discovery_ = now;
      send_due_ = now;
    }
    if (stops() && is_leaving && status.state != LifecycleState::lost) note_obeyed(id, now);
    // The coordinator leaves when the others have come to rest.
    if (status.role == Role::coordinator && status.state == LifecycleState::finished) test_is_over_ = true;
  }
  void note_obeyed(const std::string& id, Instant now) {
    const auto one = std::ranges::find(found_, id, &Found::id);
    if (one != found_.end() && !one->obeyed_after) one->obeyed_after = now - one->discovered;
  }
  [[nodiscard]] bool coordinator_obeyed() const {
    return std::ranges::any_of(found_,
                               [](const Found& one) { return one.role == Role::coordinator && one.obeyed_after; });
  }
  [[nodiscard]] bool contains(const std::string& id) const {
    return std::ranges::find(found_, id, &Found::id) != found_.end();
  }
  [[nodiscard]] std::span<const SubstructureAnnouncement> announced() const noexcept {
    return std::span{announcement_.substructures}.first(is_announced_ ? announcement_.substructure_count : 0U);
  }

  ControlVerb verb_;
  Incarnation incarnation_;
  std::unique_ptr<Inbox<ParticipantStatus>> statuses_;
  std::unique_ptr<Inbox<Event>> events_;
  std::unique_ptr<Inbox<TestAnnouncement>> announcements_;
  std::unique_ptr<Outbox<TestControl>> control_;
  std::vector<Found> found_;
  TestAnnouncement announcement_;
  bool is_announced_ = false;
  bool test_is_over_ = false;
  Instant last_discovery_{};
  Instant send_due_{};
};

/// The operator's tool on all network paths at once: a test that runs on this machine only talks through its loopback
/// interface, another one through the network.
class AllPaths final : public Node {
 public:
  AllPaths(const NetworkOptions& network, const std::string& test_name, ControlVerb verb) {
    fast_dds::FastDdsSettings settings = network.settings();
    settings.is_observer = true;
    if (!settings.loopback_only) transports_.push_back(fast_dds::make_fast_dds_transport(settings, test_name));
    settings.loopback_only = true;
    transports_.push_back(fast_dds::make_fast_dds_transport(settings, test_name));
    for (const auto& transport : transports_) paths_.push_back(std::make_unique<OperatorNode>(verb, *transport));
  }

  [[nodiscard]] Instant advance(Instant now) noexcept override {
    Instant wake = kNever;
    for (const auto& path : paths_) wake = std::min(wake, path->advance(now));
    return wake;
  }
  /// Each path asks to run every few milliseconds, so that one waker is enough.
  [[nodiscard]] Waker& waker() noexcept { return transports_.front()->waker(); }
  /// The path on which most participants of the test were found.
  [[nodiscard]] const OperatorNode& best() const {
    return **std::ranges::max_element(paths_, {}, [](const auto& path) { return path->found().size(); });
  }

 private:
  std::vector<std::unique_ptr<Transport>> transports_;
  std::vector<std::unique_ptr<OperatorNode>> paths_;
};

std::string list(const std::vector<std::string>& ids) { return fmt::format("{}", fmt::join(ids, ", ")); }

int send_control(const ControlOptions& options, ControlVerb verb) {
  constexpr Duration kDiscovery = std::chrono::seconds{5};     // for the first participant
  constexpr Duration kMore = std::chrono::milliseconds{1500};  // for further ones, after the last
  constexpr Duration kPatience = std::chrono::seconds{15};
  const ProcessClock clock;
  AllPaths paths{options.network, options.test_name, verb};
  const auto is_over = [&] {
    const Instant now = clock.now();
    const OperatorNode& path = paths.best();
    if (path.found().empty()) return now.time_since_epoch() > kDiscovery;
    if (now - path.last_discovery() > kPatience) return true;
    const bool knows_all = !path.stops() || path.is_complete() || now - path.last_discovery() > kMore;
    return knows_all && path.is_obeyed();
  };
  run_until(paths, paths.waker(), clock, is_over, [](Instant) {});

  const OperatorNode& path = paths.best();
  if (path.found().empty()) {
    fmt::print(stderr, "{}: no participant of this test was found; check the test name, --domain and --peer\n",
               options.test_name);
    return kExitConfiguration;
  }
  std::vector<std::string> obeyed;
  std::vector<std::string> not_obeyed;
  for (const Found& one : path.found()) {
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
