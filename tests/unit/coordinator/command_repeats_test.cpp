#include "coordinator/command_repeats.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <vector>

#include "core/random.hpp"

namespace hybridtest {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr Duration kPatience = milliseconds{200};
constexpr Duration kRoundTrip = milliseconds{50};

/// One substructure over a network that loses packets of either direction independently.
struct LossyExchange {
  explicit LossyExchange(Duration takes = {}) : turnaround{takes}, repeats{kPatience, takes} {}

  /// @return from the first copy to the first answer.
  Duration step() {
    const Instant opened = now;
    std::vector<Instant> sent{opened};
    repeats.open(opened);
    Instant measured = kNever;  // when the substructure has its answer
    Instant received = kNever;
    ForceMeasurement first_copy;
    Instant answered = kNever;
    ForceMeasurement answer;
    const auto arrive = [&](Instant copy) {
      if (is_lost()) return;
      const Instant at = copy + kRoundTrip / 2;
      ForceMeasurement own;
      own.command_send_time = copy.time_since_epoch();
      own.receive_time = own.send_time = at.time_since_epoch();
      if (measured == kNever) {
        received = at;
        measured = at + turnaround;
        own.send_time = measured.time_since_epoch();
      } else if (at < measured) {
        return;  // is on its way: answered once
      } else {
        own.flags = MeasurementFlags::repeated;
      }
      if (is_lost()) return;
      const Instant back = std::max(at, own.flags == MeasurementFlags::none ? measured : at) + kRoundTrip / 2;
      if (back >= answered) return;
      answered = back;
      answer = own;
    };
    arrive(opened);
    while (repeats.due() < answered) {
      const Instant copy = repeats.due();
      EXPECT_GE(copy - sent.back(), microseconds{250});
      sent.push_back(copy);
      repeats.sent_again(copy);
      arrive(copy);
    }
    repeats.answered(answer, answered);
    commands += static_cast<int>(sent.size());
    now = answered + milliseconds{1};
    return answered - opened;
  }

  /// Of many steps [round trips], without the time that the substructure takes.
  double mean_round_trips(int steps) {
    Duration sum{};
    for (int i = 0; i < steps; ++i) sum += step();
    return to_seconds(sum / steps - turnaround) / to_seconds(kRoundTrip);
  }

  bool is_lost() { return random.uniform() < loss; }

  Duration turnaround;
  CommandRepeats repeats;
  Random random{7};
  double loss = 0.0;
  int commands = 0;
  Instant now{};
};

TEST(CommandRepeats, WaitsGivenPatienceUntilItKnowsTheNetwork) {
  CommandRepeats repeats{kPatience, {}};
  repeats.open(Instant{});
  EXPECT_EQ(repeats.due(), Instant{kPatience});
  repeats.sent_again(Instant{kPatience});
  EXPECT_EQ(repeats.due(), Instant{2 * kPatience});
}

TEST(CommandRepeats, SendsNothingMoreWhereNothingIsLost) {
  for (const Duration turnaround : {Duration{}, Duration{milliseconds{20}}}) {
    LossyExchange exchange{turnaround};
    for (int i = 0; i < 1000; ++i) EXPECT_EQ(exchange.step(), kRoundTrip + turnaround);
    EXPECT_EQ(exchange.commands, 1000);
    EXPECT_EQ(exchange.repeats.copies(), 1);
  }
}

TEST(CommandRepeats, RepeatsSoonAfterUsualRoundTrip) {
  LossyExchange exchange;
  for (int i = 0; i < 100; ++i) exchange.step();
  exchange.loss = 1.0;
  exchange.repeats.open(exchange.now);
  EXPECT_EQ(exchange.repeats.due() - exchange.now, kRoundTrip + milliseconds{20});
}

TEST(CommandRepeats, BoundsTheRateWhileNobodyAnswers) {
  LossyExchange exchange;
  for (int i = 0; i < 100; ++i) exchange.step();
  exchange.repeats.open(exchange.now);
  const Instant cut = exchange.now;
  int sent = 0;
  Duration longest{};
  Instant last = cut;
  while (last < cut + std::chrono::seconds{10}) {
    const Instant due = exchange.repeats.due();
    longest = std::max(longest, due - last);
    exchange.repeats.sent_again(due);
    last = due;
    ++sent;
  }
  EXPECT_LE(sent, 50 + 40);       // 5 a second, and those of the first second
  EXPECT_LE(longest, kPatience);  // a link that is back is used at once
  EXPECT_EQ(exchange.repeats.copies(), 1);
}

TEST(CommandRepeats, SaysOnceThatACommandIsOverdue) {
  CommandRepeats repeats{kPatience, {}};
  repeats.open(Instant{});
  EXPECT_FALSE(repeats.becomes_overdue(Instant{kPatience - milliseconds{1}}));
  EXPECT_TRUE(repeats.becomes_overdue(Instant{kPatience}));
  EXPECT_FALSE(repeats.becomes_overdue(Instant{2 * kPatience}));
  repeats.open(Instant{2 * kPatience});
  EXPECT_TRUE(repeats.becomes_overdue(Instant{3 * kPatience}));
}

TEST(CommandRepeats, CopiesFollowTheLossUpAndDown) {
  LossyExchange exchange;
  exchange.loss = 0.2;
  exchange.mean_round_trips(100);
  EXPECT_GE(exchange.repeats.copies(), 3);
  exchange.loss = 0.0;
  exchange.mean_round_trips(150);
  EXPECT_EQ(exchange.repeats.copies(), 1);
}

TEST(CommandRepeats, EstimatesLossOfOneExchange) {
  LossyExchange exchange;
  exchange.loss = 0.2;
  double sum = 0.0;
  constexpr int kSteps = 4000;
  for (int i = 0; i < kSteps; ++i) {
    exchange.step();
    sum += exchange.repeats.loss();
  }
  // Both packets arrive in 0.8 squared of the cases.
  EXPECT_NEAR(sum / kSteps, 1.0 - 0.8 * 0.8, 0.02);
}

/// With many copies a step waits for the first pair of them that arrives: geometric in their spacing, which is one part
/// in 32 of a round trip. Repeating after each round trip alone, as a layer does that waits for the answer, takes the
/// sum of a geometric series of round trips.
TEST(CommandRepeats, LossesCostLittleMoreThanARoundTrip) {
  for (const double loss : {0.01, 0.05, 0.2}) {
    const double lost = 1.0 - (1.0 - loss) * (1.0 - loss);
    const double best = 1.0 + lost / (1.0 - lost) / 32.0;
    const double alone = 1.0 / (1.0 - lost);
    LossyExchange exchange;
    exchange.loss = loss;
    const double mean = exchange.mean_round_trips(5000);
    std::cout << 100.0 * loss << " % lost: " << mean << " round trips; copies without end " << best
              << ", repeats after a round trip " << alone << "; " << exchange.commands / 5000.0 << " commands a step\n";
    EXPECT_GE(mean, 1.0 + 0.9 * (best - 1.0));
    EXPECT_LE(mean, loss <= 0.05 ? 1.04 : 1.1);
  }
}

TEST(CommandRepeats, LossesCostLittleWhereTheSubstructureTakesTime) {
  for (const double loss : {0.01, 0.05, 0.2}) {
    LossyExchange exchange{milliseconds{20}};
    exchange.loss = loss;
    const double mean = exchange.mean_round_trips(5000);
    std::cout << 100.0 * loss << " % lost: " << mean << " round trips, " << exchange.commands / 5000.0
              << " commands a step\n";
    EXPECT_LE(mean, loss <= 0.05 ? 1.04 : 1.12);
  }
}

TEST(CommandRepeats, IgnoresTimesThatCannotBe) {
  LossyExchange exchange;
  for (int i = 0; i < 100; ++i) exchange.step();
  for (const Duration wrong : {Duration::min() / 4, Duration{-1}, Duration::max() / 4}) {
    exchange.repeats.open(exchange.now);
    ForceMeasurement answer;
    answer.command_send_time = exchange.now.time_since_epoch() + wrong;
    exchange.repeats.answered(answer, exchange.now + kRoundTrip);
    exchange.now += 2 * kRoundTrip;
  }
  for (const Duration wrong : {Duration::min(), Duration::max()}) {
    exchange.repeats.open(exchange.now);
    ForceMeasurement answer;
    answer.command_send_time = exchange.now.time_since_epoch();
    answer.receive_time = wrong;
    answer.send_time = Duration::max();
    exchange.repeats.answered(answer, exchange.now + kRoundTrip);
    exchange.now += 2 * kRoundTrip;
  }
  EXPECT_EQ(exchange.repeats.loss(), 0.0);
  exchange.repeats.open(exchange.now);
  EXPECT_EQ(exchange.repeats.due() - exchange.now, kRoundTrip + milliseconds{20});
}

}  // namespace
}  // namespace hybridtest
