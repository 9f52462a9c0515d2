#include "transport/simulated/simulated_network.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

#include "core/message_copies.hpp"

namespace hybridtest::simulated {

struct Member {
  std::string name;
  std::string substructure_id;      // empty where it is none
  std::optional<Duration> latency;  // of its links, where it has one of its own
  std::size_t number = 0;           // in the order of joining
  bool is_alive = true;
  Waker waker;
  TransportCounters counters;
};

/// Messages of one type that are under way or wait in an inbox. A place is used again together with the memory of its
/// message, so that a running test allocates nothing.
template <class Message>
class MessageStore {
 public:
  [[nodiscard]] std::size_t keep(const Message& message) {
    if (free_count_ == 0) {
      free_.push_back(0);
      free_[free_count_++] = messages_.size();
      messages_.push_back(std::make_unique<Message>());
    }
    const std::size_t place = free_[--free_count_];
    copy_message(message, *messages_[place]);
    return place;
  }
  /// The place gets the memory of the old message.
  void take(std::size_t place, Message& message) {
    move_message(*messages_[place], message);
    drop(place);
  }
  void drop(std::size_t place) { free_[free_count_++] = place; }

 private:
  std::vector<std::unique_ptr<Message>> messages_;
  std::vector<std::size_t> free_;  // as many as there are messages; the first `free_count_` count
  std::size_t free_count_ = 0;
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

/// Messages under way, the one that arrives next first. Nearly all arrive in the order in which they were sent: these
/// stand in a line, and only those that overtake it are sorted.
class Deliveries {
 public:
  void push(const Delivery& delivery) {
    if (first_ < line_.size() && line_.back() > delivery) {
      overtaking_.push(delivery);
      return;
    }
    if (first_ > kMostGone && 2 * first_ > line_.size()) {
      line_.erase(line_.begin(), line_.begin() + static_cast<std::ptrdiff_t>(first_));
      first_ = 0;
    }
    line_.push_back(delivery);
  }
  [[nodiscard]] Instant next_at() const noexcept {
    const Instant in_line = first_ < line_.size() ? line_[first_].at : kNever;
    return overtaking_.empty() ? in_line : std::min(in_line, overtaking_.top().at);
  }
  /// Not where there is none.
  Delivery pop() {
    if (!overtaking_.empty() && (first_ == line_.size() || line_[first_] > overtaking_.top())) {
      const Delivery next = overtaking_.top();
      overtaking_.pop();
      return next;
    }
    const Delivery next = line_[first_++];
    if (first_ == line_.size()) {
      line_.clear();
      first_ = 0;
    }
    return next;
  }

 private:
  static constexpr std::size_t kMostGone = 64;  // at the front of the line, before the rest moves up

  std::vector<Delivery> line_;
  std::size_t first_ = 0;  // in the line that has not arrived
  std::priority_queue<Delivery, std::vector<Delivery>, std::greater<>> overtaking_;
};

/// The members for whom something has arrived.
class ArrivedMembers {
 public:
  void add_member() { has_arrived_.push_back(0); }
  [[nodiscard]] std::size_t members() const noexcept { return has_arrived_.size(); }
  void add(const Member& member) {
    if (std::exchange(has_arrived_[member.number], std::uint8_t{1}) == 0) numbers_.push_back(member.number);
  }
  void take(std::vector<std::size_t>& numbers) {
    numbers.clear();
    numbers.swap(numbers_);
    for (const std::size_t number : numbers) has_arrived_[number] = 0;
  }

 private:
  std::vector<std::uint8_t> has_arrived_;  // by member
  std::vector<std::size_t> numbers_;
};

template <class Message>
struct Subscription final : Arrivals {
  Subscription(std::shared_ptr<Member> owner, std::optional<SubstructureIndex> wanted, MessageStore<Message>& messages,
               ArrivedMembers& have_arrivals)
      : member{std::move(owner)}, only{wanted}, store{messages}, arrivals{have_arrivals} {}

  std::shared_ptr<Member> member;
  std::optional<SubstructureIndex> only;
  MessageStore<Message>& store;
  ArrivedMembers& arrivals;           // of the network
  std::vector<Instant> last_arrival;  // by the number of the sender
  std::vector<std::size_t> waiting;   // a ring
  std::size_t first = 0;
  std::size_t count = 0;

  /// Of a message on its way to others as well.
  [[nodiscard]] bool wants([[maybe_unused]] const Message& message) const noexcept {
    if constexpr (std::is_same_v<Message, ParticipantStatus>) {
      return member->substructure_id.empty() || message.role == Role::coordinator ||
             message.role == Role::operator_tool || message.id.view() == member->substructure_id;
    } else if constexpr (requires { message.substructure; }) {
      return !only || *only == message.substructure;
    } else {
      return true;
    }
  }
  void arrive(std::size_t place) override {
    if (!member->is_alive) return store.drop(place);
    arrivals.add(*member);
    if (count == waiting.size() && !has_grown()) {
      ++member->counters.overflowed;
      return store.drop(place);
    }
    waiting[wrapped(first + count++)] = place;
  }
  [[nodiscard]] bool has_grown() {
    const std::size_t most = std::max(kInboxCapacity<Message>, kInboxPerMember * arrivals.members());
    if (waiting.size() >= most) return false;
    std::rotate(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(first), waiting.end());
    first = 0;
    waiting.resize(std::clamp<std::size_t>(2 * waiting.size(), 8, most));
    return true;
  }
  [[nodiscard]] bool take(Message& message) {
    if (count == 0) return false;
    store.take(waiting[first], message);
    first = wrapped(first + 1);
    --count;
    return true;
  }
  [[nodiscard]] std::size_t wrapped(std::size_t slot) const noexcept {
    return slot < waiting.size() ? slot : slot - waiting.size();
  }
  [[nodiscard]] Instant& last_arrival_from(const Member& sender) {
    if (last_arrival.size() <= sender.number) last_arrival.resize(sender.number + 1);
    return last_arrival[sender.number];
  }
};

template <class Message>
struct Channel {
  using Receivers = std::vector<std::shared_ptr<Subscription<Message>>>;

  Receivers subscriptions;
  /// Of those subscriptions that want some messages only, by what they choose by; in the same order, filled when they
  /// are first asked for.
  std::vector<Receivers> by_substructure;
  std::map<std::string, Receivers, std::less<>> by_id;
  struct Kept {
    std::shared_ptr<Member> sender;
    Message message;
  };
  std::vector<Kept> kept;             // newest per sender, for late joiners
  std::vector<std::size_t> kept_for;  // positions in `kept` from 1, by the number of the sender; 0: none
  MessageStore<Message> store;

  void add(std::shared_ptr<Subscription<Message>> subscription) {
    subscriptions.push_back(std::move(subscription));
    by_substructure.clear();
    by_id.clear();
  }
  [[nodiscard]] Receivers wanting(const Message& message) const {
    Receivers those;
    for (const auto& one : subscriptions) {
      if (one->wants(message)) those.push_back(one);
    }
    return those;
  }
  void keep(const std::shared_ptr<Member>& sender, const Message& message) {
    if (kept_for.size() <= sender->number) kept_for.resize(sender->number + 1);
    if (std::size_t& position = kept_for[sender->number]; position == 0) {
      kept.push_back({sender, message});
      position = kept.size();
    } else {
      kept[position - 1].message = message;
    }
  }
  [[nodiscard]] const Receivers& receivers(const Message& message) {
    if constexpr (requires { message.substructure; }) {
      if (by_substructure.size() <= message.substructure) by_substructure.resize(message.substructure + std::size_t{1});
      Receivers& those = by_substructure[message.substructure];
      if (those.empty()) those = wanting(message);
      return those;
    } else if constexpr (std::is_same_v<Message, ParticipantStatus>) {
      if (message.role == Role::coordinator || message.role == Role::operator_tool) return subscriptions;
      auto those = by_id.find(message.id.view());
      if (those == by_id.end()) those = by_id.emplace(message.id.text(), wanting(message)).first;
      return those->second;
    } else {
      return subscriptions;
    }
  }
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

  [[nodiscard]] Duration draw_latency(Duration least) {
    if (conditions.jitter <= Duration::zero()) return least;
    return least +
           Duration{static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(conditions.jitter.count()) + 1))};
  }

  [[nodiscard]] std::optional<Duration> latency_of(std::string_view participant) const {
    const auto given = std::ranges::find(conditions.site_latencies, participant, &SiteLatency::participant);
    return given == conditions.site_latencies.end() ? std::nullopt : std::optional{given->latency};
  }
  /// Of a link, without jitter.
  [[nodiscard]] Duration latency(const Member& from, const Member& to) const {
    if (!from.latency && !to.latency) return conditions.latency;
    return std::max(from.latency.value_or(Duration::zero()), to.latency.value_or(Duration::zero()));
  }

  /// On one link a message arrives after those sent before it, unless it is reordered.
  [[nodiscard]] Instant arrival(Duration least, Instant& last) {
    Instant at = now + draw_latency(least);
    if (happens(conditions.reordering)) {
      ++counters.reordered;
      return at + 3 * (least + conditions.jitter);
    }
    at = std::max(at, last);
    last = at;
    return at;
  }

  template <class Message>
  void post(const std::shared_ptr<Member>& from, const std::shared_ptr<Subscription<Message>>& to,
            const Message& message) {
    ++counters.sent;
    if constexpr (requires { message.substructure; }) ++counters.coupling;
    if (!kIsCertain<Message> && (is_out(*from) || is_out(*to->member) || happens(conditions.loss))) {
      ++counters.lost;
      return;
    }
    const int copies = happens(conditions.duplication) ? 2 : 1;
    if (copies == 2) ++counters.duplicated;
    const Duration least = latency(*from, *to->member);
    for (int copy = 0; copy < copies; ++copy) {
      under_way.push(
          {arrival(least, to->last_arrival_from(*from)), next_sequence++, to.get(), to->store.keep(message)});
    }
  }

  template <class Message>
  bool send(const std::shared_ptr<Member>& from, const Message& message) {
    if (!from->is_alive) return false;
    Channel<Message>& open = channel<Message>();
    if constexpr (kIsKept<Message>) open.keep(from, message);
    for (const auto& subscription : open.receivers(message)) {
      if (subscription->member != from) post(from, subscription, message);
    }
    return true;
  }

  Instant now{};
  Random random;
  NetworkConditions conditions;
  NetworkCounters counters;
  std::uint64_t next_sequence = 0;
  std::vector<std::shared_ptr<Member>> members;
  ArrivedMembers arrivals;
  Deliveries under_way;
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
  std::unique_ptr<Outbox<ForceMeasurement>> measurement_outbox(SubstructureIndex) override {
    return outbox<ForceMeasurement>();
  }
  std::unique_ptr<Inbox<ForceMeasurement>> measurement_inbox(std::uint16_t) override {
    return inbox<ForceMeasurement>();
  }
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
    auto subscription = std::make_shared<Subscription<Message>>(member_, only, channel.store, network_.arrivals);
    channel.add(subscription);
    for (const auto& [sender, message] : channel.kept) {
      if (sender != member_ && subscription->wants(message)) network_.post(sender, subscription, message);
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

std::unique_ptr<Transport> SimulatedNetwork::join(std::string_view participant, std::string_view substructure_id) {
  auto member = std::make_shared<Member>();
  member->name = participant;
  member->substructure_id = substructure_id;
  member->latency = state_->latency_of(participant);
  member->number = state_->members.size();
  state_->members.push_back(member);
  state_->arrivals.add_member();
  return std::make_unique<SimulatedTransport>(*state_, std::move(member));
}

void SimulatedNetwork::kill(std::string_view participant) {
  for (const auto& member : state_->members) {
    if (member->name == participant) member->is_alive = false;
  }
}

Instant SimulatedNetwork::next_delivery() const noexcept { return state_->under_way.next_at(); }

void SimulatedNetwork::advance_to(Instant now) {
  state_->now = now;
  while (state_->under_way.next_at() <= now) {
    const Delivery delivery = state_->under_way.pop();
    ++state_->counters.delivered;
    delivery.to->arrive(delivery.place);
  }
}

void SimulatedNetwork::take_arrivals(std::vector<std::size_t>& participants) { state_->arrivals.take(participants); }

const NetworkCounters& SimulatedNetwork::counters() const noexcept { return state_->counters; }

}  // namespace hybridtest::simulated
