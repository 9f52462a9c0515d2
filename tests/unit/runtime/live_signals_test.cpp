#include "runtime/live/live_signals.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/coordinator.hpp"
#include "core/random.hpp"

namespace hybridtest {
namespace {

using testing::ElementsAre;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double largest(const std::vector<double>& values) { return *std::ranges::max_element(values); }
double smallest(const std::vector<double>& values) { return *std::ranges::min_element(values); }

TEST(PointThinner, KeepsEveryRowWhileThereIsRoom) {
  PointThinner points{1, 8};
  for (int i = 0; i < 5; ++i) points.add(0.1 * i, std::vector<double>{1.0 * i});
  EXPECT_THAT(points.last(0), ElementsAre(0.0, 1.0, 2.0, 3.0, 4.0));
  EXPECT_EQ(points.least(0), points.last(0));
}

TEST(PointThinner, LosesNoPeakAmongAnyNumberOfRows) {
  Random random{3};
  for (int rows = 1; rows < 400; rows += 7) {
    PointThinner points{2, 8};
    std::vector<double> all;
    for (int i = 0; i < rows; ++i) {
      all.push_back(random.uniform(-1.0, 1.0));
      points.add(0.001 * i, std::vector<double>{all.back(), 3.0});
    }
    EXPECT_LE(points.model_time_s().size(), 8U) << rows;
    EXPECT_GE(points.model_time_s().size(), std::min<std::size_t>(4, all.size())) << rows;
    EXPECT_EQ(largest(points.most(0)), largest(all)) << rows;
    EXPECT_EQ(smallest(points.least(0)), smallest(all)) << rows;
    EXPECT_EQ(points.last(0).back(), all.back()) << rows;
    EXPECT_DOUBLE_EQ(points.model_time_s().back(), 0.001 * (rows - 1)) << rows;
    EXPECT_TRUE(std::ranges::is_sorted(points.model_time_s()));
  }
}

TEST(PointThinner, NumbersGoBeforeMissingValues) {
  PointThinner points{1, 2};
  for (const double value : {kNan, 2.0, 1.0, kNan}) points.add(0.0, std::vector<double>{value});
  EXPECT_EQ(points.least(0), (std::vector<double>{2.0, 1.0}));
  EXPECT_EQ(points.most(0), (std::vector<double>{2.0, 1.0}));
}

/// Blocks that were sent.
class Sent final : public Outbox<SignalBlock> {
 public:
  explicit Sent(std::vector<SignalBlock>& blocks) : blocks_{blocks} {}
  bool send(const SignalBlock& block) noexcept override {
    blocks_.push_back(block);
    return true;
  }

 private:
  std::vector<SignalBlock>& blocks_;
};

/// As many signals as wanted, each a multiple of the second column.
class Multiples final : public DerivedSignals {
 public:
  explicit Multiples(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) names_.push_back({"signal", std::to_string(i), "m"});
  }
  void read(std::span<const double> row, std::span<double> values) override {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i) * row[1];
  }
};

const TableLayout kTable{"table", {{"model_time_s", "s"}, {"value", ""}}};

TEST(LiveSignals, PublishesABlockPerDrainInPartsOfSixteen) {
  std::vector<SignalBlock> blocks;
  LiveSignals live{"storey_1", 7, std::make_unique<Sent>(blocks)};
  live.add("group", 4, kTable, std::make_unique<Multiples>(20));
  live.see(4, std::vector<double>{0.1, 1.0, 0.2, 2.0});
  live.see(3, std::vector<double>{0.3, 99.0});  // another table
  live.end_of_drain();
  live.end_of_drain();  // nothing new
  ASSERT_EQ(blocks.size(), 2U);
  EXPECT_EQ(blocks[0].participant.view(), "storey_1");
  EXPECT_EQ(blocks[0].group.view(), "group");
  EXPECT_EQ(blocks[0].signals.size(), 16U);
  EXPECT_EQ(blocks[1].part, 1);
  EXPECT_EQ(blocks[1].signals.size(), 4U);
  EXPECT_EQ(blocks[1].signals[3].subject.view(), "19");
  EXPECT_THAT(blocks[1].signals[3].last, ElementsAre(19.0, 38.0));
  EXPECT_THAT(blocks[0].model_time_s, ElementsAre(0.1, 0.2));
  live.see(4, std::vector<double>{0.3, 3.0});
  live.end_of_drain();
  ASSERT_EQ(blocks.size(), 4U);
  EXPECT_EQ(blocks[2].sequence, 1U);
  EXPECT_THAT(blocks[2].model_time_s, ElementsAre(0.3)) << "only what is new";
}

TEST(LiveSignals, ExchangesAreCountedPerSubstructure) {
  std::vector<SignalBlock> blocks;
  LiveSignals live{"coordinator", 7, std::make_unique<Sent>(blocks)};
  live.add_exchanges(1, Coordinator::exchanges_layout(), {"a", "b"}, 0.01);
  std::vector<double> rows;
  const auto exchange = [&](double step, double substructure, double round_trip_us, double attempts) {
    rows.insert(rows.end(), {step, substructure, round_trip_us, attempts, 0.0, 0.0, 0.0});
  };
  for (int step = 0; step < 100; ++step) {
    exchange(step, 0, step < 98 ? 100.0 : 900.0, 1);
    exchange(step, 1, step == 40 ? kNan : 200.0, step == 50 ? 3 : 1);
  }
  exchange(100, 0, kNan, 1);
  live.see(1, rows);
  for (int drain = 0; drain < 10; ++drain) live.end_of_drain();
  ASSERT_EQ(blocks.size(), 1U) << "twice a second";
  const auto value = [&](std::string_view name, std::string_view subject) {
    for (const LiveSignal& signal : blocks.back().signals) {
      if (signal.name.view() == name && signal.subject.view() == subject) return signal.last.back();
    }
    return kNan;
  };
  // The histogram rounds up to bins that are a sixteenth wide.
  EXPECT_NEAR(value("round_trip_p50", "a"), 100.0, 100.0 / 16.0);
  EXPECT_NEAR(value("round_trip_p99", "a"), 900.0, 900.0 / 16.0);
  EXPECT_EQ(value("answered", "a"), 100.0);
  EXPECT_EQ(value("lost", "a"), 1.0);
  EXPECT_EQ(value("bridged", "a"), 0.0);
  EXPECT_EQ(value("answered", "b"), 99.0);
  EXPECT_EQ(value("resent", "b"), 2.0);
  EXPECT_EQ(value("bridged", "b"), 1.0);
  EXPECT_EQ(value("lost", "b"), 0.0);
  EXPECT_DOUBLE_EQ(blocks.back().model_time_s.back(), 1.0);
}

}  // namespace
}  // namespace hybridtest
