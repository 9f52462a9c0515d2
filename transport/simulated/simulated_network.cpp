#include "transport/simulated/simulated_network.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

namespace hybridtest::simulated {

struct Member {
  std::string name;
  std::size_t number = 0;  // in the order of joining
  bool is_alive = true;
  bool has_arrival = false;
  Waker waker;
  TransportCounters counters;
};

/// Messages of one type that are under way or wait in an inbox. A place is used again together with the memory of its
/// message, so that a running test allocates nothing.
template <class Message>
class MessageStore {
 public:
  [[nodiscard]] std::size_t keep(const Message& message) {
    if (free_.empty()) {
      free_.push_back(messages_.size());
      messages_.emplace_back();
    }
    const std::size_t place = free_.back();
    free_.pop_back();
    messages_[place] = message;
    return place;
  }
  void take(std::size_t place, Message& message) {
    message = messages_[place];
    drop(place);
  }
  void drop(std::size_t place) { free_.push_back(place); }

 private:
  std::deque<Message> messages_;
  std::vector<std::size_t> free_;
};

/// Where messages arrive, whatever their type.
class Arrivals {
 public:
  virtual ~Arrivals() = default;
  /// @param place   in the store of the messages.
  virtual void arrive(std::size_t place) = 0;
};

/// A message on its way to one inbox; the order of sending decides between equal times.
struct Delivery {
  Instant at{};
  std::uint64_t sequence = 0;
  Arrivals* to = nullptr;  // of a subscription, which lives as long as the network
  std::size_t place = 0;

  friend bool operator>(const Delivery& a, const Delivery& b) noexcept {
    return a.at != b.at ? a.at > b.at : a.sequence > b.sequence;
  }
};

template <class Message>
struct Subscription final : Arrivals {
  Subscription(std::shared_ptr<Member> owner, std::optional<SubstructureIndex> wanted, MessageStore<Message>& messages)
      : member{std::move(owner)}, only{wanted}, store{messages} {}

  std::shared_ptr<Member> member;
  std::optional<SubstructureIndex> only;
  MessageStore<Message>& store;
  std::vector<Instant> last_arrival;  // by the number of the sender
  std::array<std::size_t, kInboxCapacity<Message>> waiting{};
  std::size_t first = 0;
  std::size_t count = 0;

  void arrive(std::size_t place) override {
    if (!member->is_alive) return store.drop(place);
    member->has_arrival = true;
    if (count == waiting.size()) {
      ++member->counters.overflowed;
      return store.drop(place);
    }
    waiting[(first + count++) % waiting.size()] = place;
  }
  [[nodiscard]] bool take(Message& message) {
    if (count == 0) return false;
    store.take(waiting[first], message);
    first = (first + 1) % waiting.size();
    --count;
    return true;
  }
  [[nodiscard]] Instant& last_arrival_from(const Member& sender) {
    if (last_arrival.size() <= sender.number) last_arrival.resize(sender.number + 1);
    return last_arrival[sender.number];
  }
};

template <class Message>
struct Channel {
  std::vector<std::shared_ptr<Subscription<Message>>> subscriptions;
  std::vector<std::pair<std::shared_ptr<Member>, Message>> kept;  // newest per sender, for late joiners
  MessageStore<Message> store;
};

template <class Message>
inline constexpr bool kIsKept = std::is_same_v<Message, TestAnnouncement> || std::is_same_v<Message, ParticipantStatus>;
template <class Message>
inline constexpr bool kIsCertain = std::is_same_v<Message, TestAnnouncement>;

struct NetworkState {
  NetworkState(std::uint64_t seed, NetworkConditions network_conditions)
      : random{seed, 0x6e657477}, conditions{std::move(network_conditions)} {}

  template <class Message>
  Channel<Message>& channel() {
    return std::get<Channel<Message>>(channels);
  }

  [[nodiscard]] bool is_out(const Member& member) const {
    return std::ranges::any_of(conditions.outages, [&](const Outage& outage) {
      return outage.participant == member.name && now.time_since_epoch() >= outage.begin &&
             now.time_since_epoch() < outage.end;
    });
  }

  [[nodiscard]] bool happens(double probability) { return probability > 0.0 && random.uniform() < probability; }

  [[nodiscard]] Duration draw_latency() {
    if (conditions.jitter <= Duration::zero()) return conditions.latency;
    return conditions.latency +
           Duration{static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(conditions.jitter.count()) + 1))};
  }

  /// On one link a message arrives after those sent before it, unless it is reordered.
  [[nodiscard]] Instant arrival(Instant& last) {
    Instant at = now + draw_latency();
    if (happens(conditions.reordering)) {
      ++counters.reordered;
      return at + 3 * (conditions.latency + conditions.jitter);
    }
    at = std::max(at, last);
    last = at;
    return at;
  }

  template <class Message>
  void post(const std::shared_ptr<Member>& from, const std::shared_ptr<Subscription<Message>>& to,
            const Message& message) {
    if (!kIsCertain<Message> && (is_out(*from) || is_out(*to->member) || happens(conditions.loss))) {
      ++counters.lost;
      return;
    }
    const int copies = happens(conditions.duplication) ? 2 : 1;
    if (copies == 2) ++counters.duplicated;
    for (int copy = 0; copy < copies; ++copy) {
      under_way.push({arrival(to->last_arrival_from(*from)), next_sequence++, to.get(), to->store.keep(message)});
    }
  }

  template <class Message>
  bool send(const std::shared_ptr<Member>& from, const Message& message) {
    if (!from->is_alive) return false;
    Channel<Message>& open = channel<Message>();
    if constexpr (kIsKept<Message>) {
      const auto same = std::ranges::find(open.kept, from, &std::pair<std::shared_ptr<Member>, Message>::first);
      if (same == open.kept.end()) {
        open.kept.emplace_back(from, message);
      } else {
        same->second = message;
      }
    }
    for (const auto& subscription : open.subscriptions) {
      if (subscription->member == from) continue;
      if constexpr (requires { message.substructure; }) {
        if (subscription->only && *subscription->only != message.substructure) continue;
      }
      post(from, subscription, message);
    }
    return true;
  }

  Instant now{};
  Random random;
  NetworkConditions conditions;
  NetworkCounters counters;
  std::uint64_t next_sequence = 0;
  std::vector<std::shared_ptr<Member>> members;
  std::priority_queue<Delivery, std::vector<Delivery>, std::greater<>> under_way;
  std::tuple<Channel<TestAnnouncement>, Channel<ParticipantStatus>, Channel<DisplacementCommand>,
             Channel<ForceMeasurement>, Channel<TestControl>, Channel<Event>, Channel<SignalBlock>>
      channels;
};

namespace {

template <class Message>
class SimulatedInbox final : public Inbox<Message> {
 public:
  explicit SimulatedInbox(std::shared_ptr<Subscription<Message>> subscription)
      : subscription_{std::move(subscription)} {}

  [[nodiscard]] bool take(Message& message) noexcept override { return subscription_->take(message); }

 private:
  std::shared_ptr<Subscription<Message>> subscription_;
};

template <class Message>
class SimulatedOutbox final : public Outbox<Message> {
 public:
  SimulatedOutbox(NetworkState& network, std::shared_ptr<Member> member)
      : network_{network}, member_{std::move(member)} {}

  bool send(const Message& message) noexcept override { return network_.send(member_, message); }

 private:
  NetworkState& network_;
  std::shared_ptr<Member> member_;
};

class SimulatedTransport final : public Transport {
 public:
  SimulatedTransport(NetworkState& network, std::shared_ptr<Member> member)
      : network_{network}, member_{std::move(member)} {}

  [[nodiscard]] Waker& waker() noexcept override { return member_->waker; }

  std::unique_ptr<Outbox<TestAnnouncement>> announcement_outbox() override { return outbox<TestAnnouncement>(); }
  std::unique_ptr<Inbox<TestAnnouncement>> announcement_inbox() override { return inbox<TestAnnouncement>(); }
  std::unique_ptr<Outbox<ParticipantStatus>> status_outbox() override { return outbox<ParticipantStatus>(); }
  std::unique_ptr<Inbox<ParticipantStatus>> status_inbox() override { return inbox<ParticipantStatus>(); }
  std::unique_ptr<Outbox<DisplacementCommand>> command_outbox(std::uint16_t) override {
    return outbox<DisplacementCommand>();
  }
  std::unique_ptr<Inbox<DisplacementCommand>> command_inbox(SubstructureIndex substructure) override {
    return inbox<DisplacementCommand>(substructure);
  }
  std::unique_ptr<Outbox<ForceMeasurement>> measurement_outbox() override { return outbox<ForceMeasurement>(); }
  std::unique_ptr<Inbox<ForceMeasurement>> measurement_inbox() override { return inbox<ForceMeasurement>(); }
  std::unique_ptr<Outbox<TestControl>> control_outbox() override { return outbox<TestControl>(); }
  std::unique_ptr<Inbox<TestControl>> control_inbox() override { return inbox<TestControl>(); }
  std::unique_ptr<Outbox<Event>> event_outbox() override { return outbox<Event>(); }
  std::unique_ptr<Inbox<Event>> event_inbox() override { return inbox<Event>(); }
  std::unique_ptr<Outbox<SignalBlock>> signal_outbox() override { return outbox<SignalBlock>(); }
  std::unique_ptr<Inbox<SignalBlock>> signal_inbox() override { return inbox<SignalBlock>(); }

  [[nodiscard]] bool reachable(SubstructureIndex) const noexcept override { return true; }
  [[nodiscard]] TransportCounters counters() const noexcept override { return member_->counters; }

 private:
  template <class Message>
  std::unique_ptr<Outbox<Message>> outbox() {
    return std::make_unique<SimulatedOutbox<Message>>(network_, member_);
  }

  template <class Message>
  std::unique_ptr<Inbox<Message>> inbox(std::optional<SubstructureIndex> only = {}) {
    Channel<Message>& channel = network_.channel<Message>();
    auto subscription = std::make_shared<Subscription<Message>>(member_, only, channel.store);
    channel.subscriptions.push_back(subscription);
    for (const auto& [sender, message] : channel.kept) {
      if (sender != member_) network_.post(sender, subscription, message);
    }
    return std::make_unique<SimulatedInbox<Message>>(std::move(subscription));
  }

  NetworkState& network_;
  std::shared_ptr<Member> member_;
};

}  // namespace

SimulatedNetwork::SimulatedNetwork(std::uint64_t seed, NetworkConditions conditions)
    : state_{std::make_unique<NetworkState>(seed, std::move(conditions))} {}

SimulatedNetwork::~SimulatedNetwork() = default;

std::unique_ptr<Transport> SimulatedNetwork::join(std::string_view participant) {
  auto member = std::make_shared<Member>();
  member->name = participant;
  member->number = state_->members.size();
  state_->members.push_back(member);
  return std::make_unique<SimulatedTransport>(*state_, std::move(member));
}

void SimulatedNetwork::kill(std::string_view participant) {
  for (const auto& member : state_->members) {
    if (member->name == participant) member->is_alive = false;
  }
}

Instant SimulatedNetwork::next_delivery() const noexcept {
  return state_->under_way.empty() ? kNever : state_->under_way.top().at;
}

void SimulatedNetwork::advance_to(Instant now) {
  state_->now = now;
  while (!state_->under_way.empty() && state_->under_way.top().at <= now) {
    const Delivery delivery = state_->under_way.top();
    state_->under_way.pop();
    ++state_->counters.delivered;
    delivery.to->arrive(delivery.place);
  }
}

bool SimulatedNetwork::take_arrival(std::size_t participant) noexcept {
  return std::exchange(state_->members[participant]->has_arrival, false);
}

const NetworkCounters& SimulatedNetwork::counters() const noexcept { return state_->counters; }

}  // namespace hybridtest::simulated
