#include "coordinator/rehearsal.hpp"

#include <gtest/gtest.h>

namespace hybridtest {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

ForceMeasurement answer(SubstructureIndex substructure, std::uint16_t round) {
  ForceMeasurement message;
  message.substructure = substructure;
  message.step = kNoStep;
  message.iteration = round;
  return message;
}

/// Runs a rehearsal in which substructure 0 answers after 100 us and every so many-th answer of 1 is lost; the others
/// take 300 us, one of them 900 us.
Rehearsal rehearsed(int lost_every) {
  Rehearsal rehearsal{2, milliseconds{1}};
  Instant now{milliseconds{7}};
  rehearsal.begin(now);
  int round = 0;
  while (!rehearsal.is_over(now)) {
    if (const auto next = rehearsal.next_round(now)) {
      EXPECT_EQ(*next, round);
      rehearsal.take(answer(0, *next), now + microseconds{100});
      rehearsal.take(answer(1, static_cast<std::uint16_t>(*next + 1)), now);  // of another round: does not count
      const Duration takes = round == 200 ? microseconds{900} : microseconds{300};
      if (lost_every == 0 || round % lost_every != 0) rehearsal.take(answer(1, *next), now + takes);
      ++round;
    }
    now = rehearsal.wake();
  }
  EXPECT_EQ(round, Rehearsal::kRoundsMost);
  return rehearsal;
}

TEST(Rehearsal, TellsPercentilesOfTheRoundTrip) {
  Rehearsal rehearsal = rehearsed(0);
  EXPECT_EQ(rehearsal.percentile(0, 99), microseconds{100});
  EXPECT_EQ(rehearsal.percentile(1, 50), microseconds{300});
  EXPECT_EQ(rehearsal.percentile(1, 99), microseconds{300}) << "one in 256 is less than one in a hundred";
  EXPECT_EQ(rehearsal.percentile(1, 100), microseconds{900});
}

TEST(Rehearsal, LostAnswersAreEndless) {
  Rehearsal rehearsal = rehearsed(50);  // six of 256
  EXPECT_EQ(rehearsal.percentile(1, 50), microseconds{300});
  EXPECT_EQ(rehearsal.percentile(1, 99), Duration::max());
  EXPECT_EQ(rehearsal.percentile(0, 99), microseconds{100}) << "of the other substructure";
}

TEST(Rehearsal, LongStepsHaveFewerRounds) {
  Rehearsal rehearsal{1, milliseconds{100}};
  Instant now{};
  rehearsal.begin(now);
  int rounds = 0;
  for (; !rehearsal.is_over(now); now = rehearsal.wake()) rounds += rehearsal.next_round(now) ? 1 : 0;
  EXPECT_EQ(rounds, 20);
  EXPECT_EQ(now, Instant{Rehearsal::kLongest});
}

}  // namespace
}  // namespace hybridtest
