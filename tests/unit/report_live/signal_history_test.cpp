#include "report/live/signal_history.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace hybridtest {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

TEST(BinnedPoints, KeepsPeaksWhenItMergesPoints) {
  BinnedPoints points{1e-4, 10};
  for (int i = 0; i < 1000; ++i) {
    const double value = i == 333 ? 7.0 : i == 777 ? -9.0 : 0.5;
    points.add({i * 1e-3, value, value, value});
  }
  ASSERT_LE(points.points().size(), 10U);
  ASSERT_GE(points.points().size(), 5U);
  double least = 0.0;
  double most = 0.0;
  double before_s = -1.0;
  for (const LivePoint& point : points.points()) {
    EXPECT_GT(point.model_time_s, before_s);
    before_s = point.model_time_s;
    least = std::min(least, point.least);
    most = std::max(most, point.most);
  }
  EXPECT_EQ(least, -9.0);
  EXPECT_EQ(most, 7.0);
  EXPECT_EQ(before_s, 0.999);
}

TEST(BinnedPoints, DropsWhatIsOlderThanItsWindow) {
  BinnedPoints points{0.01, 100, 0.1};
  for (int i = 0; i <= 100; ++i) points.add({i * 0.01, 0.0, 0.0, 0.0});
  EXPECT_GE(points.points().front().model_time_s, 1.0 - 0.1 - 1e-9);
  EXPECT_EQ(points.points().back().model_time_s, 1.0);
}

TEST(BinnedPoints, NumbersOutlastMissingValues) {
  BinnedPoints points{1.0, 10};
  points.add({0.1, kMissing, kMissing, kMissing});
  points.add({0.2, -1.0, 2.0, 1.5});
  points.add({0.3, kMissing, kMissing, kMissing});
  ASSERT_EQ(points.points().size(), 1U);
  EXPECT_EQ(points.points()[0].least, -1.0);
  EXPECT_EQ(points.points()[0].most, 2.0);
  EXPECT_TRUE(std::isnan(points.points()[0].last));
}

TEST(SignalHistory, GivesThePointsAfterACursor) {
  SignalHistory history;
  for (std::uint64_t i = 1; i <= 5; ++i) {
    EXPECT_EQ(history.add(i, {0.01 * static_cast<double>(i), 0.0, 0.0, static_cast<double>(i)}), 0U);
  }
  const std::vector<LivePoint> points = history.since(3);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].last, 4.0);
  EXPECT_EQ(points[1].last, 5.0);
  EXPECT_TRUE(history.since(5).empty());
}

TEST(SignalHistory, IsBoundedAndNamesWhatItDropped) {
  SignalHistory history;
  std::uint64_t dropped = 0;
  for (std::uint64_t i = 1; i <= 100'000; ++i) {
    const double value = i == 50 ? 3.0 : 1.0;
    dropped = std::max(dropped, history.add(i, {0.01 * static_cast<double>(i), -value, value, value}));
  }
  EXPECT_LE(history.since(0).size(), 1000U);
  EXPECT_EQ(dropped, 100'000U - history.since(0).size());
  EXPECT_LE(history.recent().size(), 2000U);
  EXPECT_GE(history.recent().front().model_time_s, 970.0 - 0.1);
  EXPECT_LE(history.whole().size(), 2000U);
  EXPECT_EQ(history.whole().front().most, 3.0);  // the peak at the beginning
  EXPECT_EQ(history.peak(), 3.0);
}

}  // namespace
}  // namespace hybridtest
