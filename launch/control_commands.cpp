#include <fmt/format.h>

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

/// Waits for the coordinator of the test, then repeats a control message until the coordinator obeys or the time is up.
class OperatorNode final : public Node {
 public:
  OperatorNode(ControlVerb verb, Transport& transport)
      : verb_{verb},
        incarnation_{draw_incarnation()},
        statuses_{transport.status_inbox()},
        events_{transport.event_inbox()},
        control_{transport.control_outbox()} {}

  [[nodiscard]] Instant advance(Instant now) noexcept override {
    ParticipantStatus status;
    while (statuses_->take(status)) {
      if (status.role != Role::coordinator) continue;
      const bool is_ending = status.state == LifecycleState::stopping || status.state == LifecycleState::finished;
      const bool stops = verb_ == ControlVerb::stop || verb_ == ControlVerb::emergency_stop;
      if (coordinator_was_seen_ && stops && is_ending) is_obeyed_ = true;
      coordinator_was_seen_ = coordinator_was_seen_ || !is_ending;
    }
    Event event;
    while (events_->take(event)) {
      const bool answers = (verb_ == ControlVerb::pause && event.code == EventCode::test_paused) ||
                           (verb_ == ControlVerb::resume && event.code == EventCode::test_resumed);
      if (answers) is_obeyed_ = true;
    }
    if (coordinator_was_seen_ && now >= send_due_) {
      TestControl message;
      message.verb = verb_;
      message.sender = incarnation_;
      message.sender_role = Role::operator_tool;
      message.reason = verb_ == ControlVerb::emergency_stop ? StopReason::interlock : StopReason::interrupted;
      control_->send(message);
      send_due_ = now + std::chrono::milliseconds{300};
    }
    return now + std::chrono::milliseconds{50};
  }

  [[nodiscard]] bool coordinator_was_seen() const noexcept { return coordinator_was_seen_; }
  [[nodiscard]] bool is_obeyed() const noexcept { return is_obeyed_; }

 private:
  ControlVerb verb_;
  Incarnation incarnation_;
  std::unique_ptr<Inbox<ParticipantStatus>> statuses_;
  std::unique_ptr<Inbox<Event>> events_;
  std::unique_ptr<Outbox<TestControl>> control_;
  Instant send_due_{};
  bool coordinator_was_seen_ = false;
  bool is_obeyed_ = false;
};

enum class Outcome : std::uint8_t { obeyed, not_obeyed, not_found };

Outcome try_on(const fast_dds::FastDdsSettings& settings, const std::string& test_name, ControlVerb verb) {
  constexpr Duration kDiscovery = std::chrono::seconds{4};
  constexpr Duration kPatience = std::chrono::seconds{15};
  const ProcessClock clock;
  const auto transport = fast_dds::make_fast_dds_transport(settings, test_name);
  OperatorNode node{verb, *transport};
  const auto is_over = [&] {
    const Duration elapsed = clock.now().time_since_epoch();
    return node.is_obeyed() || elapsed > (node.coordinator_was_seen() ? kPatience : kDiscovery);
  };
  run_until(node, transport->waker(), clock, is_over, [](Instant) {});
  if (node.is_obeyed()) return Outcome::obeyed;
  return node.coordinator_was_seen() ? Outcome::not_obeyed : Outcome::not_found;
}

int send_control(const ControlOptions& options, ControlVerb verb) {
  fast_dds::FastDdsSettings settings = options.network.settings();
  Outcome outcome = try_on(settings, options.test_name, verb);
  if (outcome == Outcome::not_found && !settings.loopback_only) {
    // A test that runs on this machine only uses only the loopback interface.
    settings.loopback_only = true;
    outcome = try_on(settings, options.test_name, verb);
  }
  switch (outcome) {
    case Outcome::obeyed: fmt::print("{}: done\n", options.test_name); return kExitCompleted;
    case Outcome::not_obeyed:
      fmt::print(
          stderr,
          "{}: the coordinator was found but did not obey within 15 s; send the command again, or stop the rigs by "
          "hand\n",
          options.test_name);
      return kExitEndedEarly;
    case Outcome::not_found:
      fmt::print(stderr, "{}: no coordinator of this test was found; check the test name, --domain and --peer\n",
                 options.test_name);
      return kExitConfiguration;
  }
  return kExitInternal;
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
