#include "transport/in_process/hub.hpp"

#include <utility>

#include "transport/in_process/channel.hpp"

namespace hybridtest::in_process {

struct HubState {
  Channel<TestAnnouncement> announcements{true};
  Channel<ParticipantStatus> statuses{true};
  Channel<DisplacementCommand> commands{false};
  Channel<ForceMeasurement> measurements{false};
  Channel<TestControl> controls{false};
  Channel<Event> events{false};
  Channel<SignalBlock> signals{false};
};

namespace {

using HubPtr = std::shared_ptr<HubState>;
using ParticipantPtr = std::shared_ptr<ParticipantState>;

template <class Message>
class ChannelOutbox final : public Outbox<Message> {
 public:
  ChannelOutbox(HubPtr hub, Channel<Message>& channel, ParticipantPtr participant)
      : hub_{std::move(hub)}, channel_{channel}, participant_{std::move(participant)} {
    channel_.add_sender(participant_);
  }
  ~ChannelOutbox() override { channel_.remove_sender(*participant_); }

  bool send(const Message& message) noexcept override {
    const bool accepted = channel_.send(participant_, message);
    if (!accepted) participant_->unsent.fetch_add(1, std::memory_order_relaxed);
    return accepted;
  }

 private:
  HubPtr hub_;  // keeps the channel alive
  Channel<Message>& channel_;
  ParticipantPtr participant_;
};

class CommandOutbox final : public Outbox<DisplacementCommand> {
 public:
  CommandOutbox(HubPtr hub, ParticipantPtr participant, std::uint16_t substructure_count)
      : participant_{participant}, inner_{hub, hub->commands, participant}, substructure_count_{substructure_count} {}

  bool send(const DisplacementCommand& command) noexcept override {
    if (command.substructure < substructure_count_) return inner_.send(command);
    participant_->unsent.fetch_add(1, std::memory_order_relaxed);
    return false;
  }

 private:
  ParticipantPtr participant_;
  ChannelOutbox<DisplacementCommand> inner_;
  std::uint16_t substructure_count_;
};

template <class Message>
class ChannelInbox final : public Inbox<Message> {
 public:
  ChannelInbox(HubPtr hub, Channel<Message>& channel, ParticipantPtr participant,
               std::optional<SubstructureIndex> only = {})
      : hub_{std::move(hub)}, channel_{channel}, subscription_{std::make_shared<Subscription<Message>>()} {
    subscription_->participant = std::move(participant);
    subscription_->only = only;
    if (subscription_->participant->alive) channel_.subscribe(subscription_);
  }
  ~ChannelInbox() override { channel_.unsubscribe(subscription_.get()); }

  [[nodiscard]] bool take(Message& message) noexcept override { return subscription_->queue.pop(message); }

 private:
  HubPtr hub_;
  Channel<Message>& channel_;
  std::shared_ptr<Subscription<Message>> subscription_;
};

template <class Message>
std::unique_ptr<Outbox<Message>> make_outbox(const HubPtr& hub, Channel<Message>& channel, const ParticipantPtr& self) {
  return std::make_unique<ChannelOutbox<Message>>(hub, channel, self);
}

template <class Message>
std::unique_ptr<Inbox<Message>> make_inbox(const HubPtr& hub, Channel<Message>& channel, const ParticipantPtr& self) {
  return std::make_unique<ChannelInbox<Message>>(hub, channel, self);
}

bool said_farewell(const ParticipantStatus& status) noexcept {
  return status.state == LifecycleState::finished || status.state == LifecycleState::refused;
}

}  // namespace

InProcessTransport::InProcessTransport(std::shared_ptr<HubState> hub, std::string_view test_name)
    : hub_{std::move(hub)}, participant_{std::make_shared<ParticipantState>()} {
  participant_->test_name = test_name;
}

InProcessTransport::~InProcessTransport() { kill(); }

void InProcessTransport::kill() noexcept {
  if (!participant_->alive.exchange(false)) return;
  hub_->announcements.leave(*participant_);
  hub_->commands.leave(*participant_);
  hub_->measurements.leave(*participant_);
  hub_->controls.leave(*participant_);
  hub_->events.leave(*participant_);
  hub_->signals.leave(*participant_);
  std::optional<ParticipantStatus> last = hub_->statuses.leave(*participant_);
  if (!last || said_farewell(*last)) return;
  last->state = LifecycleState::lost;
  hub_->statuses.for_each_reached_by(*participant_, [&](const auto& inbox) { inbox->deliver_displacing(*last); });
}

Waker& InProcessTransport::waker() noexcept { return participant_->waker; }

std::unique_ptr<Outbox<TestAnnouncement>> InProcessTransport::announcement_outbox() {
  return make_outbox(hub_, hub_->announcements, participant_);
}
std::unique_ptr<Inbox<TestAnnouncement>> InProcessTransport::announcement_inbox() {
  return make_inbox(hub_, hub_->announcements, participant_);
}
std::unique_ptr<Outbox<ParticipantStatus>> InProcessTransport::status_outbox() {
  return make_outbox(hub_, hub_->statuses, participant_);
}
std::unique_ptr<Inbox<ParticipantStatus>> InProcessTransport::status_inbox() {
  return make_inbox(hub_, hub_->statuses, participant_);
}
std::unique_ptr<Outbox<DisplacementCommand>> InProcessTransport::command_outbox(std::uint16_t substructure_count) {
  return std::make_unique<CommandOutbox>(hub_, participant_, substructure_count);
}
std::unique_ptr<Inbox<DisplacementCommand>> InProcessTransport::command_inbox(SubstructureIndex substructure) {
  return std::make_unique<ChannelInbox<DisplacementCommand>>(hub_, hub_->commands, participant_, substructure);
}
std::unique_ptr<Outbox<ForceMeasurement>> InProcessTransport::measurement_outbox(SubstructureIndex) {
  return make_outbox(hub_, hub_->measurements, participant_);
}
std::unique_ptr<Inbox<ForceMeasurement>> InProcessTransport::measurement_inbox(std::uint16_t) {
  return make_inbox(hub_, hub_->measurements, participant_);
}
std::unique_ptr<Outbox<TestControl>> InProcessTransport::control_outbox() {
  return make_outbox(hub_, hub_->controls, participant_);
}
std::unique_ptr<Inbox<TestControl>> InProcessTransport::control_inbox() {
  return make_inbox(hub_, hub_->controls, participant_);
}
std::unique_ptr<Outbox<Event>> InProcessTransport::event_outbox() {
  return make_outbox(hub_, hub_->events, participant_);
}
std::unique_ptr<Inbox<Event>> InProcessTransport::event_inbox() { return make_inbox(hub_, hub_->events, participant_); }
std::unique_ptr<Outbox<SignalBlock>> InProcessTransport::signal_outbox() {
  return make_outbox(hub_, hub_->signals, participant_);
}
std::unique_ptr<Inbox<SignalBlock>> InProcessTransport::signal_inbox() {
  return make_inbox(hub_, hub_->signals, participant_);
}

bool InProcessTransport::reachable(SubstructureIndex substructure) const noexcept {
  bool found = false;
  if (hub_->commands.has_sender(*participant_) && hub_->measurements.has_receiver(*participant_)) {
    hub_->commands.for_each_reached_by(*participant_, [&](const auto& inbox) {
      found = found || (inbox->only == substructure && hub_->measurements.has_sender(*inbox->participant));
    });
  }
  if (!found && hub_->measurements.has_sender(*participant_)) {
    hub_->commands.for_each_reaching(*participant_, substructure, [&](const ParticipantState& sender) {
      found = found || hub_->measurements.has_receiver(sender);
    });
  }
  return found;
}

TransportCounters InProcessTransport::counters() const noexcept {
  return {.overflowed = participant_->overflowed, .unsent = participant_->unsent};
}

Hub::Hub() : state_{std::make_shared<HubState>()} {}

std::unique_ptr<InProcessTransport> Hub::join(std::string_view test_name) {
  return std::make_unique<InProcessTransport>(state_, test_name);
}

}  // namespace hybridtest::in_process
