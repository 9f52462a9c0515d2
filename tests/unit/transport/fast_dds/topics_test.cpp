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

template <class Message>
bool repeats(const FastDdsSettings& settings) {
  const bool writer_does =
      writer_qos(Topic<Message>::kDelivery, settings).reliability().kind == dds::RELIABLE_RELIABILITY_QOS;
  // A reader that asks for more than the writer offers is not connected with it.
  EXPECT_EQ(writer_does, asks_for_repeats<Message>(settings));
  return writer_does;
}

TEST(CouplingQos, BestEffortIsForCommandsAndMeasurementsAlone) {
  FastDdsSettings real_time;
  real_time.best_effort_coupling = true;
  EXPECT_FALSE(repeats<DisplacementCommand>(real_time));
  EXPECT_FALSE(repeats<ForceMeasurement>(real_time));
  EXPECT_TRUE(repeats<TestAnnouncement>(real_time));
  EXPECT_TRUE(repeats<ParticipantStatus>(real_time));
  EXPECT_TRUE(repeats<TestControl>(real_time));
  EXPECT_TRUE(repeats<Event>(real_time));
}

TEST(CouplingQos, IsReliableByDefault) {
  EXPECT_TRUE(repeats<DisplacementCommand>({}));
  EXPECT_TRUE(repeats<ForceMeasurement>({}));
}

}  // namespace
}  // namespace hybridtest::fast_dds
