#include "transport/simulated/simulated_network.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace hybridtest::simulated {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr int kMessages = 20000;

/// One message per microsecond from `a` to `b`; what arrived, by number and time.
struct Arrivals {
  std::vector<int> numbers;
  std::vector<Instant> times;
  NetworkCounters counters;
};

Event numbered(int number) {
  Event event;
  event.step = number;
  return event;
}

Arrivals send_many(std::uint64_t seed, const NetworkConditions& conditions, int messages = kMessages) {
  SimulatedNetwork network{seed, conditions};
  const auto a = network.join("a");
  const auto b = network.join("b");
  const auto outbox = a->event_outbox();
  const auto inbox = b->event_inbox();
  Arrivals arrivals;
  const auto take_all = [&](Instant now) {
    Event event;
    while (inbox->take(event)) {
      arrivals.numbers.push_back(static_cast<int>(event.step));
      arrivals.times.push_back(now);
    }
  };
  for (int i = 0; i < messages; ++i) {
    const Instant now{microseconds{i}};
    network.advance_to(now);
    take_all(now);
    outbox->send(numbered(i));
  }
  while (network.next_delivery() != kNever) {
    const Instant now = network.next_delivery();
    network.advance_to(now);
    take_all(now);
  }
  arrivals.counters = network.counters();
  return arrivals;
}

TEST(SimulatedNetwork, DeliversAfterLatencyAndNotBefore) {
  SimulatedNetwork network{1, {}};
  const auto a = network.join("a");
  const auto b = network.join("b");
  const auto outbox = a->event_outbox();
  const auto inbox = b->event_inbox();
  const auto arrived = [&] {
    std::vector<std::size_t> members;
    network.take_arrivals(members);
    return members;
  };
  Event event;
  network.advance_to(Instant{milliseconds{1}});
  outbox->send(numbered(7));
  EXPECT_EQ(network.next_delivery(), Instant{milliseconds{1} + microseconds{50}});
  network.advance_to(Instant{milliseconds{1} + microseconds{50} - Duration{1}});
  EXPECT_FALSE(inbox->take(event));
  EXPECT_TRUE(arrived().empty());
  network.advance_to(Instant{milliseconds{1} + microseconds{50}});
  EXPECT_EQ(arrived(), std::vector<std::size_t>{1});
  EXPECT_TRUE(arrived().empty()) << "told once";
  ASSERT_TRUE(inbox->take(event));
  EXPECT_EQ(event.step, 7);
  EXPECT_EQ(network.next_delivery(), kNever);
}

TEST(SimulatedNetwork, KeepsOrderOfALinkUnderJitter) {
  NetworkConditions conditions;
  conditions.jitter = milliseconds{1};
  const Arrivals arrivals = send_many(3, conditions);
  ASSERT_EQ(arrivals.numbers.size(), static_cast<std::size_t>(kMessages));
  EXPECT_TRUE(std::ranges::is_sorted(arrivals.numbers));
  Duration longest{};
  for (int i = 0; i < kMessages; ++i) {
    const Duration way = arrivals.times[static_cast<std::size_t>(i)] - Instant{microseconds{i}};
    EXPECT_GE(way, conditions.latency);
    longest = std::max(longest, way);
  }
  EXPECT_LE(longest, conditions.latency + conditions.jitter);
  EXPECT_GT(longest, conditions.latency + conditions.jitter / 2);
}

TEST(SimulatedNetwork, LosesConfiguredShare) {
  NetworkConditions conditions;
  conditions.loss = 0.1;
  const Arrivals arrivals = send_many(4, conditions);
  // Four standard deviations of a binomial distribution.
  EXPECT_NEAR(static_cast<double>(arrivals.counters.lost), 0.1 * kMessages, 4.0 * std::sqrt(0.09 * kMessages));
  EXPECT_EQ(arrivals.numbers.size(), kMessages - arrivals.counters.lost);
  EXPECT_EQ(arrivals.counters.delivered, arrivals.numbers.size());
}

TEST(SimulatedNetwork, DuplicatesConfiguredShare) {
  NetworkConditions conditions;
  conditions.duplication = 0.2;
  const Arrivals arrivals = send_many(5, conditions);
  EXPECT_NEAR(static_cast<double>(arrivals.counters.duplicated), 0.2 * kMessages, 4.0 * std::sqrt(0.16 * kMessages));
  EXPECT_EQ(arrivals.numbers.size(), kMessages + arrivals.counters.duplicated);
  EXPECT_TRUE(std::ranges::is_sorted(arrivals.numbers));
}

TEST(SimulatedNetwork, ReordersConfiguredShare) {
  NetworkConditions conditions;
  conditions.reordering = 0.1;
  const Arrivals arrivals = send_many(6, conditions);
  EXPECT_NEAR(static_cast<double>(arrivals.counters.reordered), 0.1 * kMessages, 4.0 * std::sqrt(0.09 * kMessages));
  ASSERT_EQ(arrivals.numbers.size(), static_cast<std::size_t>(kMessages));
  EXPECT_FALSE(std::ranges::is_sorted(arrivals.numbers));
  std::vector<int> sorted = arrivals.numbers;
  std::ranges::sort(sorted);
  for (int i = 0; i < kMessages; ++i) ASSERT_EQ(sorted[static_cast<std::size_t>(i)], i);
}

TEST(SimulatedNetwork, ArrivalsDependOnTheSeedOnly) {
  NetworkConditions conditions;
  conditions.jitter = microseconds{300};
  conditions.loss = conditions.duplication = conditions.reordering = 0.05;
  const Arrivals first = send_many(7, conditions, 2000);
  const Arrivals again = send_many(7, conditions, 2000);
  const Arrivals other = send_many(8, conditions, 2000);
  EXPECT_EQ(first.numbers, again.numbers);
  EXPECT_EQ(first.times, again.times);
  EXPECT_NE(first.times, other.times);
}

TEST(SimulatedNetwork, OutageCutsBothDirections) {
  NetworkConditions conditions;
  conditions.outages.push_back({"a", milliseconds{10}, milliseconds{20}});
  SimulatedNetwork network{1, conditions};
  const auto a = network.join("a");
  const auto b = network.join("b");
  const auto c = network.join("c");
  const auto from_a = a->event_outbox();
  const auto from_b = b->event_outbox();
  const auto to_a = a->event_inbox();
  const auto to_c = c->event_inbox();
  for (const auto& [time, is_cut_off] : {std::pair{milliseconds{9}, false},
                                         {milliseconds{10}, true},
                                         {milliseconds{19}, true},
                                         {milliseconds{20}, false}}) {
    network.advance_to(Instant{time});
    from_a->send(numbered(1));
    from_b->send(numbered(2));
    network.advance_to(Instant{time + microseconds{50}});
    Event event;
    EXPECT_EQ(to_a->take(event), !is_cut_off);
    std::vector<Step> heard;
    while (to_c->take(event)) heard.push_back(event.step);
    EXPECT_EQ(heard, is_cut_off ? (std::vector<Step>{2}) : (std::vector<Step>{1, 2}));
  }
}

TEST(SimulatedNetwork, DeadParticipantNeitherSendsNorReceives) {
  SimulatedNetwork network{1, {}};
  const auto a = network.join("a");
  const auto b = network.join("b");
  const auto from_a = a->event_outbox();
  const auto from_b = b->event_outbox();
  const auto to_a = a->event_inbox();
  const auto to_b = b->event_inbox();
  EXPECT_TRUE(from_a->send(numbered(1)));
  from_b->send(numbered(2));
  network.kill("a");
  EXPECT_FALSE(from_a->send(numbered(3)));
  network.advance_to(Instant{seconds{1}});
  Event event;
  EXPECT_FALSE(to_a->take(event));
  ASSERT_TRUE(to_b->take(event)) << "what was under way arrives";
  EXPECT_EQ(event.step, 1);
  EXPECT_FALSE(to_b->take(event));
}

TEST(SimulatedNetwork, SenderDoesNotReceiveItsOwnMessages) {
  SimulatedNetwork network{1, {}};
  const auto a = network.join("a");
  const auto outbox = a->event_outbox();
  const auto inbox = a->event_inbox();
  outbox->send(numbered(1));
  EXPECT_EQ(network.next_delivery(), kNever);
}

TEST(SimulatedNetwork, DeliversCommandOnlyToItsSubstructure) {
  SimulatedNetwork network{1, {}};
  const auto coordinator = network.join("coordinator");
  const auto first = network.join("first");
  const auto second = network.join("second");
  const auto outbox = coordinator->command_outbox(2);
  const auto to_first = first->command_inbox(0);
  const auto to_second = second->command_inbox(1);
  DisplacementCommand command;
  command.substructure = 1;
  outbox->send(command);
  network.advance_to(Instant{seconds{1}});
  EXPECT_FALSE(to_first->take(command));
  EXPECT_TRUE(to_second->take(command));
}

TEST(SimulatedNetwork, LateJoinerGetsAnnouncementAndNewestStatuses) {
  NetworkConditions conditions;
  conditions.loss = 0.9;  // never of the announcement
  SimulatedNetwork lossy{1, conditions};
  SimulatedNetwork network{1, {}};
  for (int i = 0; i < 50; ++i) {
    const auto sender = lossy.join("a" + std::to_string(i));
    sender->announcement_outbox()->send({});
    const auto late = lossy.join("b" + std::to_string(i));
    const auto inbox = late->announcement_inbox();
    lossy.advance_to(Instant{seconds{i + 1}});
    TestAnnouncement announcement;
    EXPECT_TRUE(inbox->take(announcement));
  }
  const auto sender = network.join("sender");
  const auto statuses = sender->status_outbox();
  ParticipantStatus status;
  for (const Step step : {1, 2, 3}) {
    status.last_step = step;
    statuses->send(status);
  }
  network.advance_to(Instant{seconds{1}});
  const auto late = network.join("late");
  const auto inbox = late->status_inbox();
  network.advance_to(Instant{seconds{2}});
  ASSERT_TRUE(inbox->take(status));
  EXPECT_EQ(status.last_step, 3);
  EXPECT_FALSE(inbox->take(status));
}

TEST(SimulatedNetwork, CountsMessagesRejectedByFullInbox) {
  SimulatedNetwork network{1, {}};
  const auto a = network.join("a");
  const auto b = network.join("b");
  const auto outbox = a->control_outbox();
  const auto inbox = b->control_inbox();
  for (std::size_t i = 0; i < kInboxCapacity<TestControl> + 5; ++i) outbox->send({});
  network.advance_to(Instant{seconds{1}});
  EXPECT_EQ(b->counters().overflowed, 5U);
  TestControl control;
  std::size_t taken = 0;
  while (inbox->take(control)) ++taken;
  EXPECT_EQ(taken, kInboxCapacity<TestControl>);
}

TEST(SimulatedNetwork, SubstructureHearsCoordinatorAndItsOwnId) {
  SimulatedNetwork network{1, {}};
  const auto coordinator = network.join("coordinator");
  const auto site = network.join("site", "site");
  const auto other = network.join("other", "other");
  const auto second = network.join("second process", "site");
  const auto heard_by_all = coordinator->status_inbox();
  const auto heard_by_site = site->status_inbox();
  const auto send = [&](Transport& from, std::string_view id, Role role) {
    ParticipantStatus status;
    status.id = id;
    status.role = role;
    from.status_outbox()->send(status);
  };
  send(*coordinator, "coordinator", Role::coordinator);
  send(*other, "other", Role::experimental_site);
  send(*second, "site", Role::numerical_substructure);
  send(*network.join("tool"), "tool", Role::operator_tool);
  network.advance_to(Instant{seconds{1}});
  const auto ids = [](Inbox<ParticipantStatus>& inbox) {
    std::vector<std::string> heard;
    for (ParticipantStatus status; inbox.take(status);) heard.push_back(status.id.text());
    return heard;
  };
  EXPECT_EQ(ids(*heard_by_site), (std::vector<std::string>{"coordinator", "site", "tool"}));
  EXPECT_EQ(ids(*heard_by_all), (std::vector<std::string>{"other", "site", "tool"}));
  const auto late = network.join("late", "other")->status_inbox();
  network.advance_to(Instant{seconds{2}});
  EXPECT_EQ(ids(*late), (std::vector<std::string>{"coordinator", "other", "tool"})) << "of what is kept";
}

TEST(SimulatedNetwork, LinkIsAsLongAsItsFartherEnd) {
  NetworkConditions conditions;
  conditions.latency = milliseconds{1};
  conditions.site_latencies = {{"near", microseconds{200}}, {"far", milliseconds{7}}};
  const auto latency = [&](const char* from, const char* to) {
    SimulatedNetwork network{1, conditions};
    const auto sender = network.join(from);
    const auto receiver = network.join(to);
    const auto inbox = receiver->event_inbox();
    sender->event_outbox()->send({});
    return network.next_delivery().time_since_epoch();
  };
  EXPECT_EQ(latency("a", "b"), milliseconds{1});
  EXPECT_EQ(latency("a", "far"), milliseconds{7});
  EXPECT_EQ(latency("near", "a"), microseconds{200});
  EXPECT_EQ(latency("near", "far"), milliseconds{7});
}

TEST(SimulatedNetwork, InboxHasRoomForSomeOfEachMember) {
  constexpr std::size_t kSenders = 300;  // 300 x 4 places are more than the usual 256
  SimulatedNetwork network{1, {}};
  const auto coordinator = network.join("coordinator");
  const auto inbox = coordinator->status_inbox();
  std::vector<std::unique_ptr<Transport>> senders;
  for (std::size_t i = 0; i < kSenders; ++i) {
    senders.push_back(network.join(std::to_string(i), std::to_string(i)));
    ParticipantStatus status;
    status.id = std::to_string(i);
    for (std::size_t k = 0; k <= kInboxPerMember; ++k) senders.back()->status_outbox()->send(status);
  }
  network.advance_to(Instant{seconds{1}});
  const std::size_t room = kInboxPerMember * (kSenders + 1);
  ParticipantStatus status;
  std::size_t taken = 0;
  while (inbox->take(status)) {
    ASSERT_EQ(status.id, std::to_string(taken / (kInboxPerMember + 1))) << "in the order of sending";
    ++taken;
  }
  EXPECT_EQ(taken, room);
  EXPECT_EQ(coordinator->counters().overflowed, kSenders * (kInboxPerMember + 1) - room);
  EXPECT_EQ(network.counters().sent, kSenders * (kInboxPerMember + 1));
}

}  // namespace
}  // namespace hybridtest::simulated
