#include "core/presence.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>

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

TEST_F(PresenceTest, SendsFourHeartbeatsPerLeaseAndOnStateChange) {
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

TEST_F(PresenceTest, SendsAgainWhatTheTransportDidNotTake) {
  RingPort<ParticipantStatus> full{1};
  while (full.send(ParticipantStatus{})) {
  }
  Presence presence{Identity{"site", Role::experimental_site, 5, {}}, seconds{2}, inbox_, full, events_};
  const Instant again = presence.advance(at(seconds{1}));
  EXPECT_EQ(again, at(milliseconds{1010}));
  ParticipantStatus sent;
  while (full.take(sent)) {
  }
  EXPECT_EQ(presence.advance(again), at(milliseconds{1510})) << "a quarter of a lease after it was taken";
  ASSERT_TRUE(full.take(sent));
  EXPECT_EQ(sent.id, ParticipantId{"site"});
}

TEST_F(PresenceTest, LosesPeerSilentForTheLeaseAndNotBefore) {
  inbox_.send(status_of("coordinator", 9, LifecycleState::running));
  static_cast<void>(presence_.advance(at(seconds{1})));
  static_cast<void>(presence_.advance(at(milliseconds{2999})));
  EXPECT_TRUE(presence_.is_alive(9));
  static_cast<void>(presence_.advance(at(seconds{3})));
  EXPECT_FALSE(presence_.is_alive(9));
  EXPECT_EQ(presence_.find("coordinator")->status.state, LifecycleState::lost);
}

TEST_F(PresenceTest, WaitsForTheLinkOfASilentPeer) {
  presence_.wait_for_links(seconds{10});
  inbox_.send(status_of("coordinator", 9, LifecycleState::running));
  static_cast<void>(presence_.advance(at(seconds{1})));
  const Peer* peer = presence_.find("coordinator");
  EXPECT_FALSE(presence_.is_silent(*peer, at(milliseconds{2999})));
  EXPECT_TRUE(presence_.is_silent(*peer, at(seconds{3})));
  static_cast<void>(presence_.advance(at(milliseconds{10'999})));
  EXPECT_TRUE(presence_.is_alive(9));
  static_cast<void>(presence_.advance(at(seconds{11})));
  EXPECT_FALSE(presence_.is_alive(9));
  EXPECT_FALSE(presence_.is_silent(*peer, at(seconds{11})));
}

TEST_F(PresenceTest, CountsAChangeForEachThatAWatcherMustSee) {
  std::uint64_t seen = presence_.changes();
  const auto has_changed = [&] { return std::exchange(seen, presence_.changes()) != presence_.changes(); };
  inbox_.send(status_of("coordinator", 9, LifecycleState::running));
  static_cast<void>(presence_.advance(at(seconds{1})));
  EXPECT_TRUE(has_changed()) << "a status";
  inbox_.send(status_of("coordinator", 9, LifecycleState::running, milliseconds{1}));
  static_cast<void>(presence_.advance(at(seconds{1})));
  EXPECT_FALSE(has_changed()) << "a heartbeat that says the same";
  static_cast<void>(presence_.advance(at(milliseconds{2999})));
  EXPECT_FALSE(has_changed()) << "nothing heard, nobody lost";
  static_cast<void>(presence_.advance(at(seconds{3})));
  EXPECT_TRUE(has_changed()) << "a lease that ran out";
  presence_.raise(FaultFlags::records_dropped);
  EXPECT_TRUE(has_changed()) << "an own fault";
  presence_.raise(FaultFlags::records_dropped);
  EXPECT_FALSE(has_changed()) << "the same fault again";
}

TEST_F(PresenceTest, KnowsAsManyPeersAsItHasRoomFor) {
  constexpr int kPeers = 1000;
  Presence presence{Identity{"coordinator", Role::coordinator, 5, {}}, seconds{2}, inbox_, outbox_, events_, kPeers};
  const auto id = [](int i) { return "storey_" + std::to_string(i); };
  for (int i = 0; i <= kPeers; ++i) {
    inbox_.send(status_of(id(i).c_str(), static_cast<Incarnation>(i) + 10, LifecycleState::ready));
    static_cast<void>(presence.advance(at(seconds{0})));
  }
  ASSERT_EQ(presence.peers().size(), static_cast<std::size_t>(kPeers));
  for (int i = 0; i < kPeers; ++i) {
    const Peer* peer = presence.find(id(i));
    ASSERT_NE(peer, nullptr) << i;
    ASSERT_EQ(peer->status.incarnation, static_cast<Incarnation>(10 + i)) << i;
  }
  EXPECT_EQ(presence.find(id(kPeers)), nullptr) << "no room for one more";
}

TEST_F(PresenceTest, IgnoresOvertakenStatus) {
  ParticipantStatus newer = status_of("coordinator", 9, LifecycleState::stopping, seconds{5});
  newer.faults = FaultFlags::force_limit;
  inbox_.send(newer);
  inbox_.send(status_of("coordinator", 9, LifecycleState::running, seconds{4}));
  static_cast<void>(presence_.advance(at(seconds{0})));
  ASSERT_NE(presence_.find("coordinator"), nullptr);
  EXPECT_EQ(presence_.find("coordinator")->status.state, LifecycleState::stopping);
  EXPECT_EQ(presence_.find("coordinator")->status.faults, FaultFlags::force_limit);
  // A loss is reported with what the transport remembers, which may be older.
  inbox_.send(status_of("coordinator", 9, LifecycleState::lost, seconds{4}));
  static_cast<void>(presence_.advance(at(seconds{0})));
  EXPECT_FALSE(presence_.is_alive(9));
}

TEST_F(PresenceTest, LostPeerReturnsWhenHeardAgain) {
  inbox_.send(status_of("coordinator", 9, LifecycleState::running));
  static_cast<void>(presence_.advance(at(seconds{0})));
  static_cast<void>(presence_.advance(at(seconds{5})));
  ASSERT_FALSE(presence_.is_alive(9));
  inbox_.send(status_of("coordinator", 9, LifecycleState::running));
  static_cast<void>(presence_.advance(at(seconds{6})));
  EXPECT_TRUE(presence_.is_alive(9));
}

TEST_F(PresenceTest, IgnoresStatusAfterFarewell) {
  inbox_.send(status_of("coordinator", 9, LifecycleState::finished));
  inbox_.send(status_of("coordinator", 9, LifecycleState::running));
  static_cast<void>(presence_.advance(at(seconds{0})));
  EXPECT_EQ(presence_.find("coordinator")->status.state, LifecycleState::finished);
}

TEST_F(PresenceTest, YoungerOfTwoWithOneIdIsTheDuplicate) {
  static_cast<void>(presence_.advance(at(seconds{1})));
  inbox_.send(status_of("site", 4, LifecycleState::joining, milliseconds{700}));
  static_cast<void>(presence_.advance(at(seconds{1})));
  EXPECT_FALSE(presence_.is_duplicate()) << "the other one is younger";
  inbox_.send(status_of("site", 6, LifecycleState::joining, milliseconds{2800}));
  static_cast<void>(presence_.advance(at(milliseconds{2500})));
  EXPECT_TRUE(presence_.is_duplicate());
}

TEST_F(PresenceTest, OneOfTwoSimultaneousDuplicatesLeaves) {
  for (const Duration on_its_way : {Duration{0}, Duration{milliseconds{1}}, Duration{milliseconds{20}}}) {
    for (Duration younger_by{}; younger_by <= milliseconds{400}; younger_by += milliseconds{5}) {
      RingPort<ParticipantStatus> to_older{4};
      RingPort<ParticipantStatus> to_younger{4};
      RingPort<Event> events{16};
      Presence older{Identity{"site", Role::experimental_site, 6, {}}, seconds{2}, to_older, to_younger, events};
      Presence younger{Identity{"site", Role::experimental_site, 5, {}}, seconds{2}, to_younger, to_older, events};
      const Instant sent = at(seconds{1});
      static_cast<void>(older.advance(sent));
      static_cast<void>(younger.advance(sent - younger_by));
      static_cast<void>(older.advance(sent + on_its_way));
      static_cast<void>(younger.advance(sent - younger_by + on_its_way));
      EXPECT_TRUE(older.is_duplicate() || younger.is_duplicate())
          << to_seconds(younger_by) << " s apart, " << to_seconds(on_its_way) << " s on its way";
      // Both leave only where one sees a tie and the other may not.
      if (younger_by < milliseconds{200} || younger_by > milliseconds{250}) {
        EXPECT_NE(older.is_duplicate(), younger.is_duplicate()) << to_seconds(younger_by) << " s apart";
      }
    }
  }
}

TEST_F(PresenceTest, ArmedParticipantDoesNotLeaveForDuplicate) {
  presence_.set_state(LifecycleState::armed);
  inbox_.send(status_of("site", 6, LifecycleState::joining, seconds{100}));
  static_cast<void>(presence_.advance(at(seconds{1})));
  EXPECT_FALSE(presence_.is_duplicate());
  Event event;
  ASSERT_TRUE(events_.take(event));
  EXPECT_EQ(event.code, EventCode::duplicate_id);
}

TEST_F(PresenceTest, NewcomerLeavesForArmedDuplicate) {
  inbox_.send(status_of("site", 6, LifecycleState::running, milliseconds{1}));
  static_cast<void>(presence_.advance(at(seconds{50})));
  EXPECT_TRUE(presence_.is_duplicate());
}

TEST_F(PresenceTest, YoungerProcessDoesNotReplaceLivingPeer) {
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
