#include "transport/fast_dds/peers.hpp"

#include <gtest/gtest.h>

namespace hybridtest::fast_dds {
namespace {

GuidPrefix prefix(std::uint8_t number) {
  GuidPrefix result;
  result.value[11] = number;
  return result;
}

InstanceHandle instance(std::uint8_t number) {
  eprosima::fastrtps::rtps::GUID_t guid{prefix(number), 1};
  return InstanceHandle{guid};
}

ParticipantStatus status(LifecycleState state) {
  ParticipantStatus result;
  result.id = "site";
  result.incarnation = 5;
  result.state = state;
  return result;
}

TEST(Peers, ReportsLossOnceWithLastStatus) {
  Peers peers;
  peers.heard(prefix(1), instance(1), status(LifecycleState::ready));
  peers.heard(prefix(1), instance(1), status(LifecycleState::running));
  const auto loss = peers.gone(prefix(1));
  ASSERT_TRUE(loss);
  EXPECT_EQ(*loss, status(LifecycleState::lost));
  EXPECT_FALSE(peers.gone(prefix(1)));
}

TEST(Peers, DepartedOrUnknownPeerIsNotReported) {
  Peers peers;
  peers.heard(prefix(1), instance(1), status(LifecycleState::finished));
  peers.heard(prefix(2), instance(2), status(LifecycleState::refused));
  EXPECT_FALSE(peers.gone(prefix(1)));
  EXPECT_FALSE(peers.gone(prefix(2)));
  EXPECT_FALSE(peers.gone(prefix(3)));
}

TEST(Peers, ReturnedPeerCanBeLostAgain) {
  Peers peers;
  peers.heard(prefix(1), instance(1), status(LifecycleState::running));
  EXPECT_TRUE(peers.gone(prefix(1)));
  peers.heard(prefix(1), instance(1), status(LifecycleState::running));
  EXPECT_TRUE(peers.gone(prefix(1)));
}

TEST(Peers, SilenceMattersOnlyWhileMotionIsPossible) {
  for (const LifecycleState state : {LifecycleState::joining, LifecycleState::ready, LifecycleState::finished}) {
    Peers peers;
    peers.heard(prefix(1), instance(1), status(state));
    EXPECT_FALSE(peers.silent(instance(1)));
  }
  for (const LifecycleState state : {LifecycleState::armed, LifecycleState::running, LifecycleState::stopping}) {
    Peers peers;
    peers.heard(prefix(1), instance(1), status(state));
    EXPECT_FALSE(peers.silent(instance(2)));
    ASSERT_TRUE(peers.silent(instance(1)));
    EXPECT_FALSE(peers.silent(instance(1))) << "once";
    EXPECT_FALSE(peers.gone(prefix(1))) << "once, whatever the sign";
  }
}

TEST(Peers, RecoveredPeerCanFallSilentAgain) {
  Peers peers;
  peers.heard(prefix(1), instance(1), status(LifecycleState::running));
  EXPECT_TRUE(peers.silent(instance(1)));
  peers.heard(prefix(1), instance(1), status(LifecycleState::running));
  EXPECT_TRUE(peers.silent(instance(1)));
}

TEST(Peers, ReportsBothOfTwoWithOneId) {
  Peers peers;
  peers.heard(prefix(1), instance(1), status(LifecycleState::running));
  peers.heard(prefix(2), instance(1), status(LifecycleState::running));
  EXPECT_TRUE(peers.gone(prefix(2)));
  EXPECT_TRUE(peers.gone(prefix(1)));
}

}  // namespace
}  // namespace hybridtest::fast_dds
