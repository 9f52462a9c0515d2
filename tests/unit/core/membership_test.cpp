#include "core/membership.hpp"

#include <gtest/gtest.h>

#include "core/ring_port.hpp"
#include "tests/support/successor.hpp"

namespace hybridtest {
namespace {

using std::chrono::seconds;

class MembershipTest : public testing::Test {
 protected:
  static constexpr Incarnation kCoordinator = 77;

  void announce(ScenarioDigest digest = {}) {
    TestAnnouncement announcement;
    announcement.coordinator = kCoordinator;
    announcement.scenario_digest = digest;
    announcements_.send(announcement);
  }
  void control(ControlVerb verb, Incarnation sender = kCoordinator, Role role = Role::coordinator) {
    TestControl message;
    message.verb = verb;
    message.sender = sender;
    message.sender_role = role;
    control_.send(message);
  }
  void coordinator_is(LifecycleState state) {
    ParticipantStatus status;
    status.id = "coordinator";
    status.role = Role::coordinator;
    status.incarnation = kCoordinator;
    status.state = state;
    statuses_.send(status);
  }
  Request request_at(Duration since_start) {
    static_cast<void>(presence_.advance(Instant{since_start}));
    return membership_.next_request(Instant{since_start});
  }
  EventCode last_event() {
    Event event;
    while (events_.take(event)) {
    }
    return event.code;
  }

  RingPort<ParticipantStatus> statuses_{64};
  RingPort<ParticipantStatus> own_statuses_{64};
  RingPort<Event> events_{64};
  RingPort<TestAnnouncement> announcements_{4};
  RingPort<TestControl> control_{16};
  Presence presence_{Identity{"site", Role::experimental_site, 5, {}}, seconds{2}, statuses_, own_statuses_, events_};
  Membership membership_{presence_, MembershipPorts{announcements_, control_, seconds{30}}};
};

TEST_F(MembershipTest, IsReadyWhenAnnouncedScenarioMatches) {
  announce();
  EXPECT_EQ(request_at(seconds{1}), Request::none);
  EXPECT_EQ(presence_.state(), LifecycleState::ready);
  EXPECT_EQ(membership_.coordinator(), kCoordinator);
}

TEST_F(MembershipTest, RefusesOtherScenario) {
  announce({1, 2, 3});
  EXPECT_EQ(request_at(seconds{1}), Request::stop);
  EXPECT_EQ(presence_.state(), LifecycleState::refused);
  EXPECT_EQ(membership_.stop_reason(), StopReason::refused);
  EXPECT_EQ(last_event(), EventCode::digest_mismatch);
}

TEST_F(MembershipTest, LeavesWithoutACoordinatorAfterTheDiscoveryTimeout) {
  EXPECT_EQ(request_at(seconds{29}), Request::none);
  EXPECT_EQ(request_at(seconds{30}), Request::stop);
  EXPECT_EQ(membership_.stop_reason(), StopReason::not_assembled);
}

TEST_F(MembershipTest, ObeysOnlyItsCoordinator) {
  announce();
  static_cast<void>(request_at(seconds{1}));
  control(ControlVerb::arm, kCoordinator + 1);
  EXPECT_EQ(request_at(seconds{1}), Request::none);
  control(ControlVerb::arm);
  EXPECT_EQ(request_at(seconds{1}), Request::arm);
}

TEST_F(MembershipTest, DoesNotStartBeforeArming) {
  announce();
  static_cast<void>(request_at(seconds{1}));
  control(ControlVerb::start);
  EXPECT_EQ(request_at(seconds{1}), Request::none);
  presence_.set_state(LifecycleState::armed);
  control(ControlVerb::start);
  EXPECT_EQ(request_at(seconds{1}), Request::start);
}

TEST_F(MembershipTest, AcceptsEmergencyStopFromAnySender) {
  control(ControlVerb::emergency_stop, 1234, Role::operator_tool);
  EXPECT_EQ(request_at(seconds{1}), Request::emergency_stop);
  EXPECT_TRUE(any(presence_.faults() & FaultFlags::emergency_stop));
}

TEST_F(MembershipTest, DetectsLossOfCoordinator) {
  announce();
  coordinator_is(LifecycleState::running);
  EXPECT_EQ(request_at(seconds{1}), Request::none);
  EXPECT_EQ(request_at(std::chrono::milliseconds{2999}), Request::none);
  EXPECT_EQ(request_at(seconds{3}), Request::stop);
  EXPECT_EQ(membership_.stop_reason(), StopReason::coordinator_lost);
  EXPECT_TRUE(any(presence_.faults() & FaultFlags::coordinator_lost));
}

/// A participant that waits for a resumed coordinator for ten seconds; it runs, and its coordinator is lost at 3 s.
class WaitingMembershipTest : public MembershipTest {
 protected:
  Request ask_at(Duration since_start) {
    static_cast<void>(presence_.advance(Instant{since_start}));
    return patient_.next_request(Instant{since_start});
  }
  void lose_coordinator() {
    announce();
    coordinator_is(LifecycleState::running);
    EXPECT_EQ(ask_at(seconds{1}), Request::none);
    presence_.set_state(LifecycleState::running);
    EXPECT_EQ(ask_at(seconds{3}), Request::pause);
  }

  Membership patient_{presence_, MembershipPorts{announcements_, control_, seconds{30}, seconds{10}}};
};

TEST_F(WaitingMembershipTest, WaitsForALostCoordinator) {
  lose_coordinator();
  EXPECT_EQ(presence_.state(), LifecycleState::waiting);
  EXPECT_EQ(last_event(), EventCode::coordinator_awaited);
  EXPECT_FALSE(any(presence_.faults()));
  EXPECT_EQ(ask_at(seconds{12}), Request::none);
}

TEST_F(WaitingMembershipTest, EndsTheTestWhenNobodyComesInTime) {
  lose_coordinator();
  EXPECT_EQ(ask_at(seconds{13}), Request::stop);
  EXPECT_EQ(patient_.stop_reason(), StopReason::coordinator_lost);
  EXPECT_TRUE(any(presence_.faults() & FaultFlags::coordinator_lost));
}

TEST_F(WaitingMembershipTest, AcceptsASuccessorOfTheSameTest) {
  lose_coordinator();
  announce_successor(announcements_, statuses_, kCoordinator);
  EXPECT_EQ(ask_at(seconds{5}), Request::none);
  EXPECT_EQ(presence_.state(), LifecycleState::armed);
  EXPECT_EQ(patient_.coordinator(), kSuccessor);
  EXPECT_TRUE(patient_.has_successor());
  EXPECT_EQ(last_event(), EventCode::coordinator_succeeded);
  control(ControlVerb::start);
  EXPECT_EQ(ask_at(seconds{5}), Request::none) << "the lost one has nothing to say any more";
  control(ControlVerb::start, kSuccessor);
  EXPECT_EQ(ask_at(seconds{5}), Request::start);
}

TEST_F(WaitingMembershipTest, IgnoresSuccessorsOfOtherTests) {
  lose_coordinator();
  announce_successor(announcements_, statuses_, kCoordinator + 5);
  announce_successor(announcements_, statuses_, kCoordinator, {1, 2, 3});
  announce_successor(announcements_, statuses_, 0);
  EXPECT_EQ(ask_at(seconds{5}), Request::none);
  EXPECT_EQ(presence_.state(), LifecycleState::waiting);
  EXPECT_EQ(patient_.coordinator(), kCoordinator);
}

TEST_F(WaitingMembershipTest, SuccessorWaitsUntilTheLossIsKnown) {
  announce();
  coordinator_is(LifecycleState::running);
  static_cast<void>(ask_at(seconds{1}));
  presence_.set_state(LifecycleState::running);
  announce_successor(announcements_, statuses_, kCoordinator);
  EXPECT_EQ(ask_at(seconds{2}), Request::none);
  EXPECT_EQ(presence_.state(), LifecycleState::running);
  EXPECT_EQ(patient_.coordinator(), kCoordinator);
}

TEST_F(WaitingMembershipTest, GoesOnWhenItsCoordinatorIsHeardAgain) {
  lose_coordinator();
  coordinator_is(LifecycleState::running);
  EXPECT_EQ(ask_at(seconds{4}), Request::resume);
  EXPECT_EQ(presence_.state(), LifecycleState::running);
  EXPECT_FALSE(patient_.has_successor());
}

TEST_F(WaitingMembershipTest, DoesNotWaitForOneThatLeftInOrder) {
  announce();
  coordinator_is(LifecycleState::running);
  static_cast<void>(ask_at(seconds{1}));
  presence_.set_state(LifecycleState::running);
  coordinator_is(LifecycleState::finished);
  EXPECT_EQ(ask_at(seconds{2}), Request::stop);
}

TEST_F(WaitingMembershipTest, StopsForTheOperatorWhileItWaits) {
  lose_coordinator();
  control(ControlVerb::stop, 1234, Role::operator_tool);
  EXPECT_EQ(ask_at(seconds{4}), Request::stop);
  EXPECT_EQ(patient_.stop_reason(), StopReason::interrupted);
}

TEST_F(WaitingMembershipTest, NewcomerCannotJoinAResumedTest) {
  announce_successor(announcements_, statuses_, kCoordinator);
  EXPECT_EQ(ask_at(seconds{1}), Request::stop);
  EXPECT_EQ(presence_.state(), LifecycleState::refused);
  EXPECT_EQ(last_event(), EventCode::resume_refused);
}

TEST_F(WaitingMembershipTest, RestoredOneJoinsAResumedTestAlone) {
  Membership restored{presence_, MembershipPorts{announcements_, control_, seconds{30}, seconds{10}, true}};
  announce_successor(announcements_, statuses_, kCoordinator);
  static_cast<void>(presence_.advance(Instant{seconds{1}}));
  EXPECT_EQ(restored.next_request(Instant{seconds{1}}), Request::none);
  EXPECT_EQ(presence_.state(), LifecycleState::ready);
  EXPECT_TRUE(restored.has_successor());
}

}  // namespace
}  // namespace hybridtest
