#include "coordinator/step_ledger.hpp"

#include <gtest/gtest.h>

namespace hybridtest {
namespace {

ForceMeasurement answer(SubstructureIndex substructure, Step step, Incarnation sender) {
  ForceMeasurement measurement;
  measurement.substructure = substructure;
  measurement.step = step;
  measurement.sender = sender;
  return measurement;
}

class StepLedgerTest : public testing::Test {
 protected:
  StepLedgerTest() {
    ledger_.bind(0, 10);
    ledger_.bind(1, 11);
    ledger_.open(4, 0, Instant{Duration{100}});
  }
  StepLedger ledger_{2};
  Instant now_{Duration{350}};
};

TEST_F(StepLedgerTest, IsCompleteWhenEverySubstructureAnswered) {
  EXPECT_EQ(ledger_.enter(answer(1, 4, 11), now_), LedgerEntry::accepted);
  EXPECT_FALSE(ledger_.is_complete());
  EXPECT_EQ(ledger_.enter(answer(0, 4, 10), now_), LedgerEntry::accepted);
  EXPECT_TRUE(ledger_.is_complete());
  EXPECT_EQ(ledger_.round_trip(1), Duration{250});
}

TEST_F(StepLedgerTest, CountsEachAnswerOnce) {
  EXPECT_EQ(ledger_.enter(answer(1, 4, 11), now_), LedgerEntry::accepted);
  EXPECT_EQ(ledger_.enter(answer(1, 4, 11), now_), LedgerEntry::duplicate);
  EXPECT_FALSE(ledger_.is_complete());
}

TEST_F(StepLedgerTest, RejectsAnswersToOtherSteps) {
  EXPECT_EQ(ledger_.enter(answer(1, 3, 11), now_), LedgerEntry::stale);
  EXPECT_EQ(ledger_.enter(answer(1, 5, 11), now_), LedgerEntry::early);
  EXPECT_EQ(ledger_.enter(answer(1, 4, 12), now_), LedgerEntry::foreign) << "another process than the one armed";
  EXPECT_EQ(ledger_.enter(answer(7, 4, 11), now_), LedgerEntry::foreign);
  EXPECT_FALSE(ledger_.has_answered(1));
}

TEST_F(StepLedgerTest, OpeningNextStepClearsAnswers) {
  static_cast<void>(ledger_.enter(answer(0, 4, 10), now_));
  static_cast<void>(ledger_.enter(answer(1, 4, 11), now_));
  ledger_.open(5, 0, now_);
  EXPECT_FALSE(ledger_.is_complete());
  EXPECT_EQ(ledger_.enter(answer(0, 4, 10), now_), LedgerEntry::stale);
}

TEST_F(StepLedgerTest, MatchesAnswersByIteration) {
  const auto answer_to = [](Step step, std::uint16_t iteration) {
    ForceMeasurement measurement = answer(0, step, 10);
    measurement.iteration = iteration;
    return measurement;
  };
  ledger_.open(4, 2, now_);
  EXPECT_EQ(ledger_.iteration(), 2);
  EXPECT_EQ(ledger_.enter(answer_to(3, 9), now_), LedgerEntry::stale);
  EXPECT_EQ(ledger_.enter(answer_to(4, 1), now_), LedgerEntry::stale);
  EXPECT_EQ(ledger_.enter(answer_to(4, 3), now_), LedgerEntry::early);
  EXPECT_EQ(ledger_.enter(answer_to(5, 0), now_), LedgerEntry::early);
  EXPECT_EQ(ledger_.enter(answer_to(4, 2), now_), LedgerEntry::accepted);
  EXPECT_EQ(ledger_.enter(answer_to(4, 2), now_), LedgerEntry::duplicate);
}

}  // namespace
}  // namespace hybridtest
