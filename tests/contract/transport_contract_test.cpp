// The contract of every Transport (transport/transport.hpp), tested on each of them.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "tests/contract/networks.hpp"
#include "tests/contract/sample_messages.hpp"
#ifdef CONTRACT_OVER_FAST_DDS
#include "tests/contract/fast_dds/fast_dds_networks.hpp"
#endif

namespace hybridtest {
namespace {

template <class Network>
class TransportContract : public ::testing::Test {
 protected:
  std::unique_ptr<Transport> join() { return network_.join(unique_test_name()); }
  std::unique_ptr<Transport> join_other_test() { return network_.join(unique_test_name("_other")); }

 private:
  Network network_;
};

#ifdef CONTRACT_OVER_FAST_DDS
using Networks =
    ::testing::Types<InProcessNetwork, FastDdsUdpNetwork, FastDdsSharedMemoryNetwork, FastDdsBestEffortNetwork>;
#else
using Networks = ::testing::Types<InProcessNetwork>;
#endif
TYPED_TEST_SUITE(TransportContract, Networks);

/// Sends until a message comes out (before both ends know each other one may be lost) that
/// `is_it` takes for this one.
template <class Message, class IsIt>
[[nodiscard]] bool passes_as(Transport& receiver, Outbox<Message>& outbox, Inbox<Message>& inbox,
                             const Message& message, Message& received, IsIt is_it) {
  return eventually(receiver, [&] {
    outbox.send(message);
    while (inbox.take(received)) {
      if (is_it(received)) return true;
    }
    return false;
  });
}

template <class Message>
[[nodiscard]] bool passes(Transport& receiver, Outbox<Message>& outbox, Inbox<Message>& inbox, const Message& message,
                          Message& received) {
  return passes_as(receiver, outbox, inbox, message, received, [&](const Message& m) { return m == message; });
}

/// A coordinator and the two substructures it couples, ready to talk.
struct Coupled {
  Coupled(const std::function<std::unique_ptr<Transport>()>& join)
      : coordinator{join()}, site{join()}, numerical{join()} {
    commands = coordinator->command_outbox(2);
    measurements = coordinator->measurement_inbox(2);
    site_commands = site->command_inbox(0);
    site_measurements = site->measurement_outbox(0);
    numerical_commands = numerical->command_inbox(1);
    numerical_measurements = numerical->measurement_outbox(1);
    // Each direction is known to work once something came through; what was repeated on the way
    // is taken out again.
    DisplacementCommand command;
    ForceMeasurement measurement;
    ready = eventually(*coordinator, [&] { return coordinator->reachable(0) && coordinator->reachable(1); }) &&
            passes(*site, *commands, *site_commands, sample_command(0, 0), command) &&
            passes(*numerical, *commands, *numerical_commands, sample_command(1, 0), command) &&
            passes(*coordinator, *site_measurements, *measurements, sample_measurement(0, 0), measurement) &&
            passes(*coordinator, *numerical_measurements, *measurements, sample_measurement(1, 0), measurement) &&
            flush(*commands, *site, *site_commands, sample_command(0, 1)) &&
            flush(*commands, *numerical, *numerical_commands, sample_command(1, 1)) &&
            flush(*site_measurements, *coordinator, *measurements, sample_measurement(0, 1)) &&
            flush(*numerical_measurements, *coordinator, *measurements, sample_measurement(1, 1));
  }

  /// Everything sent before the marker has been taken when the marker comes out.
  template <class Message>
  [[nodiscard]] static bool flush(Outbox<Message>& outbox, Transport& receiver, Inbox<Message>& inbox,
                                  const Message& marker) {
    outbox.send(marker);
    return eventually(receiver, [&] {
      Message received;
      while (inbox.take(received)) {
        if (received == marker) return true;
      }
      return false;
    });
  }

  std::unique_ptr<Transport> coordinator;
  std::unique_ptr<Transport> site;
  std::unique_ptr<Transport> numerical;
  std::unique_ptr<Outbox<DisplacementCommand>> commands;
  std::unique_ptr<Inbox<ForceMeasurement>> measurements;
  std::unique_ptr<Inbox<DisplacementCommand>> site_commands;
  std::unique_ptr<Outbox<ForceMeasurement>> site_measurements;
  std::unique_ptr<Inbox<DisplacementCommand>> numerical_commands;
  std::unique_ptr<Outbox<ForceMeasurement>> numerical_measurements;
  bool ready = false;
};

TYPED_TEST(TransportContract, EveryMessageArrivesUnchanged) {
  const auto sender = this->join();
  const auto receiver = this->join();

  const auto check = [&](auto outbox, auto inbox, const auto& message) {
    auto received = std::remove_cvref_t<decltype(message)>{};
    ASSERT_TRUE(passes_as(*receiver, *outbox, *inbox, message, received, [](const auto&) { return true; }));
    EXPECT_EQ(received, message);
  };
  check(sender->announcement_outbox(), receiver->announcement_inbox(), sample_announcement());
  check(sender->status_outbox(), receiver->status_inbox(), sample_status("site"));
  check(sender->command_outbox(32), receiver->command_inbox(31), sample_command(31, 5));
  check(sender->measurement_outbox(31), receiver->measurement_inbox(32), sample_measurement(31, 6));
  check(sender->control_outbox(), receiver->control_inbox(), sample_control());
  check(sender->event_outbox(), receiver->event_inbox(), sample_event());
  check(sender->signal_outbox(), receiver->signal_inbox(), sample_signals());
}

TYPED_TEST(TransportContract, NonFiniteForceArrivesUnchanged) {
  const auto sender = this->join();
  const auto receiver = this->join();
  const auto outbox = sender->measurement_outbox(0);
  const auto inbox = receiver->measurement_inbox(1);
  ForceMeasurement message = sample_measurement(0, 1);
  message.force_n[0] = std::numeric_limits<double>::quiet_NaN();
  message.force_n[1] = -std::numeric_limits<double>::infinity();
  ForceMeasurement received;
  ASSERT_TRUE(passes_as(*receiver, *outbox, *inbox, message, received, [](const auto&) { return true; }));
  EXPECT_TRUE(std::isnan(received.force_n[0]));
  EXPECT_EQ(received.force_n[1], -std::numeric_limits<double>::infinity());
}

TYPED_TEST(TransportContract, KeepsOrderOfOneSenderWithoutLoss) {
  Coupled test{[this] { return this->join(); }};
  ASSERT_TRUE(test.ready);
  constexpr Step kBurst = 8;  // less than any queue holds
  for (Step first = 0; first < 20 * kBurst; first += kBurst) {
    for (Step step = first; step < first + kBurst; ++step) EXPECT_TRUE(test.commands->send(sample_command(0, step)));
    for (Step step = first; step < first + kBurst; ++step) {
      DisplacementCommand received;
      ASSERT_TRUE(eventually(*test.site, [&] { return test.site_commands->take(received); }));
      ASSERT_EQ(received.newest().step, step);
    }
  }
}

TYPED_TEST(TransportContract, RoutesCommandsBySubstructureAndAllMeasurements) {
  Coupled test{[this] { return this->join(); }};
  ASSERT_TRUE(test.ready);
  ASSERT_TRUE(test.commands->send(sample_command(1, 7)));
  ASSERT_TRUE(test.commands->send(sample_command(0, 8)));

  DisplacementCommand command;
  ASSERT_TRUE(eventually(*test.site, [&] { return test.site_commands->take(command); }));
  EXPECT_EQ(command, sample_command(0, 8));
  ASSERT_TRUE(eventually(*test.numerical, [&] { return test.numerical_commands->take(command); }));
  EXPECT_EQ(command, sample_command(1, 7));

  ASSERT_TRUE(test.site_measurements->send(sample_measurement(0, 8)));
  ASSERT_TRUE(test.numerical_measurements->send(sample_measurement(1, 7)));
  Step sum = 0;
  for (int i = 0; i < 2; ++i) {
    ForceMeasurement measurement;
    ASSERT_TRUE(eventually(*test.coordinator, [&] { return test.measurements->take(measurement); }));
    EXPECT_EQ(measurement, sample_measurement(measurement.substructure, measurement.substructure == 0 ? 8 : 7));
    sum += measurement.step;
  }
  EXPECT_EQ(sum, 15) << "one from each";
  EXPECT_FALSE(test.site_commands->take(command));
  EXPECT_FALSE(test.numerical_commands->take(command));
}

TYPED_TEST(TransportContract, RejectsCommandForUnknownSubstructure) {
  const auto coordinator = this->join();
  const auto commands = coordinator->command_outbox(2);
  EXPECT_TRUE(commands->send(sample_command(1, 0)));
  EXPECT_EQ(coordinator->counters().unsent, 0U);
  EXPECT_FALSE(commands->send(sample_command(2, 0)));
  EXPECT_EQ(coordinator->counters().unsent, 1U);
}

TYPED_TEST(TransportContract, LateJoinerGetsAnnouncementAndNewestStatuses) {
  const auto coordinator = this->join();
  const auto site = this->join();
  const auto announcement = coordinator->announcement_outbox();
  const auto coordinator_status = coordinator->status_outbox();
  const auto site_status = site->status_outbox();
  announcement->send(sample_announcement());
  coordinator_status->send(sample_status("coordinator", LifecycleState::joining));
  coordinator_status->send(sample_status("coordinator", LifecycleState::ready));
  site_status->send(sample_status("site", LifecycleState::armed));

  const auto late = this->join();
  const auto announcements = late->announcement_inbox();
  const auto statuses = late->status_inbox();
  TestAnnouncement received;
  ASSERT_TRUE(eventually(*late, [&] { return announcements->take(received); }));
  EXPECT_EQ(received, sample_announcement());
  std::vector<ParticipantStatus> heard;
  ASSERT_TRUE(eventually(*late, [&] {
    ParticipantStatus status;
    while (statuses->take(status)) heard.push_back(status);
    return heard.size() >= 2;
  }));
  ASSERT_EQ(heard.size(), 2U);
  if (heard[0].id == ParticipantId{"site"}) std::swap(heard[0], heard[1]);
  EXPECT_EQ(heard[0], sample_status("coordinator", LifecycleState::ready));
  EXPECT_EQ(heard[1], sample_status("site", LifecycleState::armed));
}

TYPED_TEST(TransportContract, TestsOfDifferentNamesAreIsolated) {
  const auto here = this->join();
  const auto here_too = this->join();
  const auto elsewhere = this->join_other_test();
  const auto foreign_status = elsewhere->status_outbox();
  const auto foreign_announcement = elsewhere->announcement_outbox();
  const auto foreign_commands = elsewhere->command_outbox(1);
  foreign_status->send(sample_status("foreign"));
  foreign_announcement->send(sample_announcement());

  const auto statuses = here->status_inbox();
  const auto announcements = here->announcement_inbox();
  const auto commands = here->command_inbox(0);
  const auto measurements = here->measurement_outbox(0);
  const auto foreign_measurements = elsewhere->measurement_inbox(1);
  const auto status = here_too->status_outbox();

  // Waits for someone of this test, who joined after the foreigner.
  ParticipantStatus received;
  const auto is_anyone = [](const auto&) { return true; };
  ASSERT_TRUE(passes_as(*here, *status, *statuses, sample_status("native"), received, is_anyone));
  do EXPECT_EQ(received.id, ParticipantId{"native"});
  while (statuses->take(received));
  foreign_commands->send(sample_command(0, 1));
  TestAnnouncement announcement;
  DisplacementCommand command;
  EXPECT_FALSE(announcements->take(announcement));
  EXPECT_FALSE(commands->take(command));
  EXPECT_FALSE(elsewhere->reachable(0));
}

TYPED_TEST(TransportContract, ParticipantDoesNotReceiveItsOwnMessages) {
  const auto self = this->join();
  const auto other = this->join();
  const auto inbox = self->status_inbox();
  const auto own = self->status_outbox();
  const auto others = other->status_outbox();
  own->send(sample_status("self"));
  ParticipantStatus received;
  const auto is_anyone = [](const auto&) { return true; };
  ASSERT_TRUE(passes_as(*self, *others, *inbox, sample_status("other"), received, is_anyone));
  do EXPECT_EQ(received.id, ParticipantId{"other"});
  while (inbox->take(received));
}

TYPED_TEST(TransportContract, ReceivesBothParticipantsWithOneId) {
  const auto first = this->join();
  const auto second = this->join();
  const auto observer = this->join();
  const auto first_status = first->status_outbox();
  const auto second_status = second->status_outbox();
  ParticipantStatus status = sample_status("site");
  status.incarnation = 1;
  first_status->send(status);
  status.incarnation = 2;
  second_status->send(status);
  const auto statuses = observer->status_inbox();
  bool heard_first = false;
  bool heard_second = false;
  EXPECT_TRUE(eventually(*observer, [&] {
    ParticipantStatus received;
    while (statuses->take(received)) {
      heard_first = heard_first || received.incarnation == 1;
      heard_second = heard_second || received.incarnation == 2;
    }
    return heard_first && heard_second;
  }));
}

TYPED_TEST(TransportContract, ReportsSilentLeaverLostOnce) {
  const auto observer = this->join();
  const auto statuses = observer->status_inbox();
  auto polite = this->join();
  auto rude = this->join();
  auto polite_status = polite->status_outbox();
  auto rude_status = rude->status_outbox();
  ParticipantStatus received;
  ASSERT_TRUE(
      passes(*observer, *polite_status, *statuses, sample_status("polite", LifecycleState::finished), received));
  ASSERT_TRUE(passes(*observer, *rude_status, *statuses, sample_status("rude", LifecycleState::running), received));

  polite_status.reset();
  polite.reset();
  rude_status.reset();
  rude.reset();
  std::vector<ParticipantStatus> lost;
  ASSERT_TRUE(eventually(*observer, [&] {
    while (statuses->take(received)) {
      if (received.state == LifecycleState::lost) lost.push_back(received);
    }
    return !lost.empty();
  }));
  ParticipantStatus expected = sample_status("rude", LifecycleState::running);
  expected.state = LifecycleState::lost;
  EXPECT_EQ(lost.front(), expected);

  // Another participant joins and leaves; meanwhile no loss is reported twice, and no regular leaver is reported.
  auto last = this->join();
  auto last_status = last->status_outbox();
  ASSERT_TRUE(passes(*observer, *last_status, *statuses, sample_status("last"), received));
  last_status.reset();
  last.reset();
  ASSERT_TRUE(eventually(*observer, [&] {
    while (statuses->take(received)) {
      if (received.state == LifecycleState::lost) lost.push_back(received);
    }
    return lost.back().id == ParticipantId{"last"};
  }));
  EXPECT_EQ(lost.size(), 2U);
}

TYPED_TEST(TransportContract, FullInboxRejectsCountsAndRecovers) {
  Coupled test{[this] { return this->join(); }};
  ASSERT_TRUE(test.ready);
  constexpr std::size_t kCapacity = kInboxCapacity<DisplacementCommand>;
  Step step = 0;
  // Every send returns although no receiver reads: sending never waits.
  ASSERT_TRUE(eventually(*test.site, [&] {
    test.commands->send(sample_command(0, step++));
    return test.site->counters().overflowed > 0;
  }));
  EXPECT_GE(step, static_cast<Step>(kCapacity));

  DisplacementCommand received;
  std::size_t taken = 0;
  Step last = -1;
  while (test.site_commands->take(received)) {
    ++taken;
    EXPECT_GT(received.newest().step, last);
    last = received.newest().step;
  }
  EXPECT_GE(taken, kCapacity);
  EXPECT_LE(last, step);

  const Step sentinel = step + 1000;
  ASSERT_TRUE(eventually(*test.site, [&] {
    test.commands->send(sample_command(0, sentinel));
    while (test.site_commands->take(received)) {
      if (received.newest().step == sentinel) return true;
    }
    return false;
  }));
}

TYPED_TEST(TransportContract, SendReturnsWithoutReceivers) {
  const auto alone = this->join();
  const auto commands = alone->command_outbox(1);
  const auto events = alone->event_outbox();
  const auto announcement = alone->announcement_outbox();
  for (Step step = 0; step < 2000; ++step) {
    EXPECT_TRUE(commands->send(sample_command(0, step)));
    EXPECT_TRUE(events->send(sample_event()));
    EXPECT_TRUE(announcement->send(sample_announcement()));
  }
}

TYPED_TEST(TransportContract, ReachableFollowsTheOtherEnd) {
  const auto coordinator = this->join();
  auto site = this->join();
  const auto commands = coordinator->command_outbox(2);
  const auto measurements = coordinator->measurement_inbox(2);
  // Ports of the same participant at the other end do not count.
  const auto own_commands = coordinator->command_inbox(0);
  const auto own_measurements = coordinator->measurement_outbox(0);
  commands->send(sample_command(0, 0));
  EXPECT_FALSE(coordinator->reachable(0));
  auto site_commands = site->command_inbox(0);
  auto site_measurements = site->measurement_outbox(0);
  EXPECT_TRUE(eventually(*coordinator, [&] { return coordinator->reachable(0); }));
  EXPECT_FALSE(coordinator->reachable(1));
  EXPECT_TRUE(eventually(*site, [&] { return site->reachable(0); }));
  EXPECT_FALSE(site->reachable(1));
  site_commands.reset();
  site_measurements.reset();
  site.reset();
  EXPECT_TRUE(eventually(*coordinator, [&] { return !coordinator->reachable(0); }));
}

TYPED_TEST(TransportContract, SubstructureIsReachedByOneWhoHasBothPorts) {
  const auto site = this->join();
  const auto site_commands = site->command_inbox(0);
  const auto site_measurements = site->measurement_outbox(0);
  auto sender = this->join();
  const auto receiver = this->join();
  auto commands = sender->command_outbox(1);
  const auto measurements = receiver->measurement_inbox(1);
  DisplacementCommand command;
  ASSERT_TRUE(passes(*site, *commands, *site_commands, sample_command(0, 1), command));
  EXPECT_FALSE(site->reachable(0)) << "the one who commands does not hear the answers";
  const auto senders_measurements = sender->measurement_inbox(1);
  EXPECT_TRUE(eventually(*site, [&] { return site->reachable(0); }));
  commands.reset();
  EXPECT_TRUE(eventually(*site, [&] { return !site->reachable(0); }));
}

TYPED_TEST(TransportContract, ArrivalSignalsWaker) {
  Coupled test{[this] { return this->join(); }};
  ASSERT_TRUE(test.ready);
  Waker& waker = test.site->waker();
  while (waker.wait_until(std::chrono::steady_clock::time_point{})) {  // uses up signals of the start
  }
  ASSERT_TRUE(test.commands->send(sample_command(0, 1)));
  ASSERT_TRUE(waker.wait_until(std::chrono::steady_clock::now() + std::chrono::seconds{30}));
  DisplacementCommand command;
  EXPECT_TRUE(test.site_commands->take(command));
}

}  // namespace
}  // namespace hybridtest
