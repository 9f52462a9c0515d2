#include "core/presence.hpp"

#include <gtest/gtest.h>

#include "core/ring_port.hpp"

namespace hybridtest {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Instant at(Duration since_start) { return Instant{since_start}; }

class PresenceTest : public testing::Test {
 protected:
  static ParticipantStatus status_of(const char* id, Incarnation incarnation, LifecycleState state, Duration age = {}) {
    ParticipantStatus status;
    status.id = id;
    status.incarnation = incarnation;
    status.state = state;
    status.clock = age;
    return status;
  }

  RingPort<ParticipantStatus> inbox_{64};
  RingPort<ParticipantStatus> outbox_{64};
  RingPort<Event> events_{64};
  Presence presence_{Identity{"site", Role::experimental_site, 5, {}}, seconds{2}, inbox_, outbox_, events_};
};

TEST_F(PresenceTest, SendsAHeartbeatFourTimesALeaseAndAtOnceWhenTheStateChanges) {
  ParticipantStatus sent;
  EXPECT_EQ(presence_.advance(at(seconds{0})), at(milliseconds{500}));
  EXPECT_TRUE(outbox_.take(sent));
  static_cast<void>(presence_.advance(at(milliseconds{499})));
  EXPECT_FALSE(outbox_.take(sent));
  static_cast<void>(presence_.advance(at(milliseconds{500})));
  EXPECT_TRUE(outbox_.take(sent));
  EXPECT_EQ(sent.clock, milliseconds{500});

  presence_.set_state(LifecycleState::ready);
  static_cast<void>(presence_.advance(at(milliseconds{501})));
  ASSERT_TRUE(outbox_.take(sent));
  EXPECT_EQ(sent.state, LifecycleState::ready);
}

TEST_F(PresenceTest, LosesAPeerThatIsSilentForTheLeaseAndNotBefore) {
  inbox_.send(status_of("coordinator", 9, LifecycleState::running));
  static_cast<void>(presence_.advance(at(seconds{1})));
  static_cast<void>(presence_.advance(at(milliseconds{2999})));
  EXPECT_TRUE(presence_.is_alive(9));
  static_cast<void>(presence_.advance(at(seconds{3})));
  EXPECT_FALSE(presence_.is_alive(9));
  EXPECT_EQ(presence_.find("coordinator")->status.state, LifecycleState::lost);
}

TEST_F(PresenceTest, ALostPeerThatIsHeardAgainIsBack) {
  inbox_.send(status_of("coordinator", 9, LifecycleState::running));
  static_cast<void>(presence_.advance(at(seconds{0})));
  static_cast<void>(presence_.advance(at(seconds{5})));
  ASSERT_FALSE(presence_.is_alive(9));
  inbox_.send(status_of("coordinator", 9, LifecycleState::running));
  static_cast<void>(presence_.advance(at(seconds{6})));
  EXPECT_TRUE(presence_.is_alive(9));
}

TEST_F(PresenceTest, AStatusThatArrivesAfterTheFarewellChangesNothing) {
  inbox_.send(status_of("coordinator", 9, LifecycleState::finished));
  inbox_.send(status_of("coordinator", 9, LifecycleState::running));
  static_cast<void>(presence_.advance(at(seconds{0})));
  EXPECT_EQ(presence_.find("coordinator")->status.state, LifecycleState::finished);
}

TEST_F(PresenceTest, TheYoungerOfTwoWithOneIdIsTheDuplicate) {
  static_cast<void>(presence_.advance(at(seconds{1})));
  inbox_.send(status_of("site", 6, LifecycleState::joining, milliseconds{900}));
  static_cast<void>(presence_.advance(at(seconds{1})));
  EXPECT_FALSE(presence_.is_duplicate()) << "the other one is younger";
  inbox_.send(status_of("site", 6, LifecycleState::joining, milliseconds{2600}));
  static_cast<void>(presence_.advance(at(milliseconds{2500})));
  EXPECT_TRUE(presence_.is_duplicate());
}

TEST_F(PresenceTest, OneThatIsArmedDoesNotLeaveForAnother) {
  presence_.set_state(LifecycleState::armed);
  inbox_.send(status_of("site", 6, LifecycleState::joining, seconds{100}));
  static_cast<void>(presence_.advance(at(seconds{1})));
  EXPECT_FALSE(presence_.is_duplicate());
  Event event;
  ASSERT_TRUE(events_.take(event));
  EXPECT_EQ(event.code, EventCode::duplicate_id);
}

TEST_F(PresenceTest, ANewcomerLeavesForOneThatIsArmedHoweverYoung) {
  inbox_.send(status_of("site", 6, LifecycleState::running, milliseconds{1}));
  static_cast<void>(presence_.advance(at(seconds{50})));
  EXPECT_TRUE(presence_.is_duplicate());
}

TEST_F(PresenceTest, AYoungerProcessDoesNotTakeThePlaceOfALivingPeer) {
  inbox_.send(status_of("other", 10, LifecycleState::running));
  inbox_.send(status_of("other", 11, LifecycleState::joining));
  static_cast<void>(presence_.advance(at(seconds{0})));
  EXPECT_EQ(presence_.find("other")->status.incarnation, 10U);
  inbox_.send(status_of("other", 10, LifecycleState::lost));
  inbox_.send(status_of("other", 11, LifecycleState::joining));
  static_cast<void>(presence_.advance(at(seconds{0})));
  EXPECT_EQ(presence_.find("other")->status.incarnation, 11U);
}

}  // namespace
}  // namespace hybridtest
