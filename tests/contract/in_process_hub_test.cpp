#include "transport/in_process/hub.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <thread>
#include <vector>

#include "tests/contract/networks.hpp"
#include "tests/contract/sample_messages.hpp"

namespace hybridtest::in_process {
namespace {

TEST(InProcessHub, KilledParticipantIsSilentAndReportedLost) {
  Hub hub;
  const auto observer = hub.join("test");
  const auto victim = hub.join("test");
  const auto statuses = observer->status_inbox();
  const auto observer_status = observer->status_outbox();
  const auto victim_status = victim->status_outbox();
  const auto victim_statuses = victim->status_inbox();
  ASSERT_TRUE(victim_status->send(sample_status("victim")));
  ParticipantStatus received;
  ASSERT_TRUE(statuses->take(received));

  victim->kill();
  ASSERT_TRUE(statuses->take(received));
  EXPECT_EQ(received.state, LifecycleState::lost);
  EXPECT_EQ(received.id, ParticipantId{"victim"});
  EXPECT_FALSE(victim_status->send(sample_status("victim")));
  EXPECT_TRUE(observer_status->send(sample_status("observer")));
  EXPECT_FALSE(victim_statuses->take(received));
  EXPECT_FALSE(statuses->take(received));
  const auto late = hub.join("test");
  const auto late_statuses = late->status_inbox();
  ASSERT_TRUE(late_statuses->take(received));
  EXPECT_EQ(received.id, ParticipantId{"observer"});
  EXPECT_FALSE(late_statuses->take(received)) << "what the dead had said went with him";
}

TEST(InProcessHub, SendReportsFullReceiver) {
  Hub hub;
  const auto sender = hub.join("test");
  const auto receiver = hub.join("test");
  const auto outbox = sender->control_outbox();
  const auto inbox = receiver->control_inbox();
  for (std::size_t i = 0; i < kInboxCapacity<TestControl>; ++i) ASSERT_TRUE(outbox->send(sample_control()));
  EXPECT_FALSE(outbox->send(sample_control()));
  EXPECT_EQ(sender->counters().unsent, 1U);
  EXPECT_EQ(receiver->counters().overflowed, 1U);
}

TEST(InProcessHub, ReportsLossEvenIntoFullInbox) {
  Hub hub;
  const auto observer = hub.join("test");
  auto victim = hub.join("test");
  const auto statuses = observer->status_inbox();
  const auto status = victim->status_outbox();
  while (status->send(sample_status("victim"))) {
  }
  victim.reset();
  ParticipantStatus received;
  while (statuses->take(received)) {
  }
  EXPECT_EQ(received.state, LifecycleState::lost);
}

TEST(InProcessHub, PortsRemainValidAfterTransportAndHubAreDestroyed) {
  auto hub = std::make_unique<Hub>();
  auto participant = hub->join("test");
  const auto outbox = participant->event_outbox();
  const auto inbox = participant->event_inbox();
  participant.reset();
  hub.reset();
  Event event;
  EXPECT_FALSE(outbox->send(sample_event()));
  EXPECT_FALSE(inbox->take(event));
}

TEST(InProcessHub, ThreadsSendWhileParticipantsJoinAndLeave) {
  Hub hub;
  const auto receiver = hub.join("test");
  const auto inbox = receiver->measurement_inbox(4);
  constexpr int kSenders = 4;
  constexpr Step kMessages = 2000;
  std::vector<std::thread> threads;
  for (SubstructureIndex sender = 0; sender < kSenders; ++sender) {
    threads.emplace_back([&hub, sender] {
      const auto self = hub.join("test");
      const auto outbox = self->measurement_outbox(sender);
      const auto status = self->status_outbox();
      for (Step step = 0; step < kMessages; ++step) {
        while (!outbox->send(sample_measurement(sender, step))) std::this_thread::yield();
        if (step % 100 == 0) {
          const auto visitor = hub.join("test");
          const auto statuses = visitor->status_inbox();
          status->send(sample_status("sender"));
        }
      }
    });
  }
  std::vector<Step> next(kSenders, 0);
  int finished = 0;
  while (finished < kSenders) {
    ASSERT_TRUE(receiver->waker().wait_until(std::chrono::steady_clock::now() + std::chrono::seconds{30}));
    ForceMeasurement measurement;
    while (inbox->take(measurement)) {
      ASSERT_EQ(measurement.step, next[measurement.substructure]++);
      if (measurement.step == kMessages - 1) ++finished;
    }
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace hybridtest::in_process
