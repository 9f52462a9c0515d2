#include "transport/fast_dds/topics.hpp"

#include <gtest/gtest.h>

namespace hybridtest::fast_dds {
namespace {

template <class Message>
bool asks_for_repeats(const FastDdsSettings& settings) {
  return reader_qos(Topic<Message>::kDelivery, settings).reliability().kind == dds::RELIABLE_RELIABILITY_QOS;
}

TEST(ReaderQos, ObserverIsSentAgainOnlyWhatLateJoinersNeed) {
  FastDdsSettings observer;
  observer.is_observer = true;
  observer.reads_best_effort = true;
  EXPECT_TRUE(asks_for_repeats<TestAnnouncement>(observer));
  EXPECT_TRUE(asks_for_repeats<ParticipantStatus>(observer));
  EXPECT_FALSE(asks_for_repeats<Event>(observer));
  EXPECT_FALSE(asks_for_repeats<SignalBlock>(observer));
  EXPECT_TRUE(asks_for_repeats<Event>({}));  // control: a participant
}

}  // namespace
}  // namespace hybridtest::fast_dds
