#include "recording/summary/clock_relation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.hpp"

namespace hybridtest {
namespace {

/// The reading error that relate_clocks() allows for.
constexpr double kReading_s = 20e-6;

/// A clock with an offset and a drift, and exchanges with it.
struct Truth {
  double offset_s = 0.0;  // when the coordinator's clock stands at zero
  double drift = 0.0;

  [[nodiscard]] double offset_at(double coordinator_s) const { return offset_s + drift * coordinator_s; }
  /// @param there_s, back_s   latencies
  [[nodiscard]] ClockBounds exchange(double sent_s, double there_s, double back_s) const {
    const double answered_s = sent_s + there_s + back_s;
    return {.there_at_s = sent_s,
            .there_s = offset_at(sent_s + there_s) + there_s,
            .back_at_s = answered_s,
            .back_s = back_s - offset_at(answered_s - back_s),
            .exchanges = 1.0,
            .mean_there_s = offset_at(sent_s + there_s) + there_s,
            .mean_back_s = back_s - offset_at(answered_s - back_s)};
  }
};

TEST(ClockRelation, NothingIsKnownWithoutAnExchange) { EXPECT_FALSE(relate_clocks({})); }

TEST(ClockRelation, EqualLatenciesGiveTheOffsetItself) {
  const Truth truth{.offset_s = 2.5, .drift = 0.0};
  std::vector<ClockBounds> bounds;
  for (int i = 0; i < 60; ++i) bounds.push_back(truth.exchange(0.5 * i, 0.001, 0.001));
  const auto relation = relate_clocks(bounds);
  ASSERT_TRUE(relation);
  EXPECT_NEAR(relation->offset_s, 2.5, 1e-12);
  EXPECT_NEAR(relation->offset_uncertainty_s, 0.001 + kReading_s, 1e-12);  // half the round trip
  // Lines from the upper bound at one end to the lower one at the other: round trip over length.
  EXPECT_NEAR(relation->drift, 0.0, 1e-8);  // the answer comes 2 ms after the command
  EXPECT_NEAR(relation->drift_uncertainty, 2.0 * (0.001 + kReading_s) / 29.5, 1e-8);
  EXPECT_NEAR(relation->latency_there_s, 0.001, 1e-9);
  EXPECT_NEAR(relation->latency_back_s, 0.001, 1e-9);
  EXPECT_NEAR(relation->to_coordinator_s(12.5), 10.0, 1e-7);
}

TEST(ClockRelation, UnequalLatenciesAreWithinTheUncertainty) {
  const Truth truth{.offset_s = -40.0, .drift = 0.0};
  std::vector<ClockBounds> bounds;
  for (int i = 0; i < 20; ++i) bounds.push_back(truth.exchange(0.5 * i, 0.030, 0.010));
  const auto relation = relate_clocks(bounds);
  ASSERT_TRUE(relation);
  // Nobody can tell them apart: the estimate is off by half the difference, and says that it may be.
  EXPECT_NEAR(relation->offset_s, -40.0 + 0.010, 1e-9);
  EXPECT_NEAR(relation->offset_uncertainty_s, 0.020 + kReading_s, 1e-9);
}

TEST(ClockRelation, UncertaintyHoldsTheTruthInEveryDraw) {
  constexpr int kDraws = 500;
  Random random{20261123, 1};
  int without_uncertainty = 0;
  double widest_drift = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Truth truth{.offset_s = random.uniform(-5.0, 5.0), .drift = random.uniform(-100e-6, 100e-6)};
    const double there_s = random.uniform(50e-6, 0.1);
    const double back_s = random.uniform(50e-6, 0.1);
    std::vector<ClockBounds> bounds;
    const int windows = 4 + static_cast<int>(random.below(237));
    for (int i = 0; i < windows; ++i) {
      // Queues only add to a latency.
      bounds.push_back(truth.exchange(0.5 * i, there_s - 0.01 * std::log(1.0 - random.uniform(0.0, 1.0)),
                                      back_s - 0.01 * std::log(1.0 - random.uniform(0.0, 1.0))));
    }
    const auto relation = relate_clocks(bounds);
    ASSERT_TRUE(relation);
    EXPECT_LE(std::abs(relation->offset_s - truth.offset_at(relation->at_s)), relation->offset_uncertainty_s) << draw;
    EXPECT_LE(std::abs(relation->drift - truth.drift), relation->drift_uncertainty + 1e-9) << draw;
    EXPECT_LE(std::abs(relation->latency_there_s - relation->latency_back_s - (there_s - back_s)),
              2.0 * relation->offset_uncertainty_s + 0.02)
        << draw;
    for (const double at_s : {relation->begin_s, relation->end_s}) {
      const double reading_s = at_s + truth.offset_at(at_s);
      EXPECT_LE(std::abs(relation->to_coordinator_s(reading_s) - at_s), relation->uncertainty_s(at_s)) << draw;
      without_uncertainty += std::abs(relation->to_coordinator_s(reading_s) - at_s) > 1e-3 ? 1 : 0;
    }
    if (windows > 200) widest_drift = std::max(widest_drift, relation->drift_uncertainty);
  }
  EXPECT_GT(without_uncertainty, kDraws / 2) << "control: an estimate alone is wrong by milliseconds";
  EXPECT_LT(widest_drift, 0.2 * 2.0 / 100.0) << "the round trip over the time between its two ends";
}

TEST(ClockRelation, FalseReadingsAreLeftOut) {
  const Truth truth{.offset_s = 1.0, .drift = 40e-6};
  std::vector<ClockBounds> bounds;
  for (int i = 0; i < 40; ++i) bounds.push_back(truth.exchange(0.5 * i, 100e-6, 100e-6));
  for (const std::size_t at : {3U, 17U, 30U}) bounds[at].there_s -= 0.004;  // read 4 ms before its message came
  bounds[25].back_s -= 0.002;
  const auto relation = relate_clocks(bounds);
  ASSERT_TRUE(relation);
  EXPECT_LE(std::abs(relation->offset_s - truth.offset_at(relation->at_s)), relation->offset_uncertainty_s);
  EXPECT_LE(std::abs(relation->drift - truth.drift), relation->drift_uncertainty);
  EXPECT_LT(relation->offset_uncertainty_s, 2.0 * 120e-6);
}

TEST(ClockRelation, NothingIsKnownWhenAllContradict) {
  const Truth truth{.offset_s = 1.0, .drift = 0.0};
  std::vector<ClockBounds> bounds{truth.exchange(0.0, 100e-6, 100e-6)};
  bounds[0].there_s -= 0.004;
  EXPECT_FALSE(relate_clocks(bounds));
}

TEST(ClockRelation, APartIsFoundByTheClockOfTheParticipant) {
  ParticipantClock clock;
  clock.parts.push_back({.begin_s = 0.0, .end_s = 100.0, .at_s = 50.0, .offset_s = 1000.0});
  clock.parts.push_back({.begin_s = 100.5, .end_s = 200.0, .at_s = 150.0, .offset_s = 1000.1});
  EXPECT_EQ(clock.at(1050.0).offset_s, 1000.0);
  EXPECT_EQ(clock.at(1150.0).offset_s, 1000.1);
  EXPECT_EQ(clock.at(0.0).offset_s, 1000.0);
  EXPECT_EQ(clock.at(9999.0).offset_s, 1000.1);
}

}  // namespace
}  // namespace hybridtest
