#include "runtime/operator_control.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hybridtest {
namespace {

using testing::ElementsAre;

constexpr Incarnation kSender = 7;

Instant after_ms(int milliseconds) { return Instant{std::chrono::milliseconds{milliseconds}}; }

ParticipantStatus status_of(const char* id, LifecycleState state) {
  ParticipantStatus status;
  status.id = id;
  status.role = status.id == ParticipantId{kCoordinatorId} ? Role::coordinator : Role::experimental_site;
  status.state = state;
  return status;
}

TEST(OperatorRequest, EmergencyStopGoesToWhomIsFoundAtOnce) {
  OperatorRequest request{ControlVerb::emergency_stop, kSender};
  EXPECT_FALSE(request.due(after_ms(0)));  // nobody is there
  request.learn(status_of("site", LifecycleState::running), after_ms(5));
  const auto message = request.due(after_ms(5));
  ASSERT_TRUE(message);
  EXPECT_EQ(message->verb, ControlVerb::emergency_stop);
  EXPECT_EQ(message->reason, StopReason::emergency_stop);
  EXPECT_EQ(message->sender, kSender);
  EXPECT_EQ(message->sender_role, Role::operator_tool);
}

TEST(OperatorRequest, RepeatsUntilAllHaveObeyed) {
  OperatorRequest request{ControlVerb::stop, kSender};
  request.learn(status_of("coordinator", LifecycleState::running), after_ms(0));
  request.learn(status_of("site", LifecycleState::running), after_ms(0));
  EXPECT_TRUE(request.due(after_ms(0)));
  EXPECT_FALSE(request.due(after_ms(19)));
  EXPECT_TRUE(request.due(after_ms(20)));
  request.learn(status_of("site", LifecycleState::lost), after_ms(30));
  EXPECT_FALSE(request.is_obeyed());  // nobody knows what a lost one does
  request.learn(status_of("site", LifecycleState::stopping), after_ms(40));
  EXPECT_FALSE(request.is_obeyed());
  request.learn(status_of("coordinator", LifecycleState::finished), after_ms(50));
  EXPECT_TRUE(request.is_obeyed());
  EXPECT_TRUE(request.is_complete());
}

TEST(OperatorRequest, StopWaitsOneSecondForTheCoordinator) {
  OperatorRequest request{ControlVerb::stop, kSender};
  request.learn(status_of("site", LifecycleState::running), after_ms(0));
  EXPECT_FALSE(request.due(after_ms(999)));  // the site would end the test, and the coordinator be gone unseen
  request.learn(status_of("coordinator", LifecycleState::running), after_ms(999));
  EXPECT_TRUE(request.due(after_ms(999)));
}

TEST(OperatorRequest, StopGoesToTheSitesWhereNoCoordinatorIsFound) {
  OperatorRequest request{ControlVerb::stop, kSender};
  request.learn(status_of("site", LifecycleState::running), after_ms(0));
  EXPECT_FALSE(request.due(after_ms(999)));
  EXPECT_TRUE(request.due(after_ms(1000)));
}

TEST(OperatorRequest, PauseWaitsForTheCoordinatorToBeHeard) {
  OperatorRequest request{ControlVerb::pause, kSender};
  request.learn(status_of("site", LifecycleState::running), after_ms(0));
  EXPECT_FALSE(request.due(after_ms(1000)));
  request.learn(status_of("coordinator", LifecycleState::running), after_ms(1000));
  EXPECT_FALSE(request.due(after_ms(1299)));
  EXPECT_TRUE(request.due(after_ms(1300)));
  EXPECT_FALSE(request.due(after_ms(1500)));
  Event paused;
  paused.source = "coordinator";
  paused.code = EventCode::test_resumed;
  request.learn(paused, after_ms(1500));
  EXPECT_FALSE(request.is_obeyed());
  paused.code = EventCode::test_paused;
  request.learn(paused, after_ms(1500));
  EXPECT_TRUE(request.is_obeyed());
}

TEST(OperatorRequest, RefusedPauseIsNotSentAgain) {
  OperatorRequest request{ControlVerb::pause, kSender};
  request.learn(status_of("coordinator", LifecycleState::running), after_ms(0));
  EXPECT_TRUE(request.due(after_ms(1000)));
  EXPECT_FALSE(request.is_refused());
  Event refused;
  refused.source = "coordinator";
  refused.code = EventCode::pause_refused;
  request.learn(refused, after_ms(1100));
  EXPECT_TRUE(request.is_refused());
  EXPECT_FALSE(request.is_obeyed());
  EXPECT_FALSE(request.due(after_ms(60'000)));
}

TEST(OperatorRequest, ParticipantsThatAreKnownAreNotWaitedFor) {  // as of an observer that was there before
  OperatorRequest request{ControlVerb::pause, kSender};
  request.learn(status_of("coordinator", LifecycleState::running), after_ms(0));
  EXPECT_TRUE(request.due(after_ms(60'000)));
}

TEST(OperatorRequest, NamesAnnouncedParticipantsThatAreMissing) {
  OperatorRequest request{ControlVerb::stop, kSender};
  TestAnnouncement announcement;
  announcement.substructures = {{"site", Role::experimental_site, 1}, {"frame", Role::numerical_substructure, 1}};
  request.learn(announcement);
  request.learn(status_of("site", LifecycleState::running), after_ms(0));
  EXPECT_THAT(request.missing(), ElementsAre("coordinator", "frame"));
  EXPECT_FALSE(request.is_complete());
}

}  // namespace
}  // namespace hybridtest
