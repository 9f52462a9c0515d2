#include "core/membership.hpp"

#include <gtest/gtest.h>

#include "core/ring_port.hpp"

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

}  // namespace
}  // namespace hybridtest
