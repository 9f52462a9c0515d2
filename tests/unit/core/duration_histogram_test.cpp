#include "core/duration_histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/random.hpp"

namespace hybridtest {
namespace {

TEST(DurationHistogramTest, PutsEachDurationIntoItsBin) {
  Random random{4};
  for (int i = 0; i < 100000; ++i) {
    const Duration duration{static_cast<std::int64_t>(std::exp2(random.uniform(0.0, 39.9)))};
    DurationHistogram histogram;
    histogram.record(duration);
    int bin = 0;
    while (histogram.count_in(bin) == 0) ++bin;
    ASSERT_LE(DurationHistogram::begin_of(bin), duration);
    ASSERT_GT(DurationHistogram::begin_of(bin + 1), duration);
    const auto width = DurationHistogram::begin_of(bin + 1) - DurationHistogram::begin_of(bin);
    ASSERT_LE(16 * (width - Duration{1}), duration) << "at most a sixteenth wide";
  }
}

TEST(DurationHistogramTest, QuantilesAreExactToASixteenth) {
  Random random{5};
  DurationHistogram histogram;
  std::vector<std::int64_t> sample;
  for (int i = 0; i < 10000; ++i) {
    sample.push_back(static_cast<std::int64_t>(1e4 * -std::log(random.uniform())) + 100);
    histogram.record(Duration{sample.back()});
  }
  std::ranges::sort(sample);
  for (const double share : {0.01, 0.5, 0.99, 0.999}) {
    const auto exact = static_cast<double>(sample[static_cast<std::size_t>(share * 10000.0) - 1]);
    const auto found = static_cast<double>(histogram.quantile(share).count());
    EXPECT_GE(found, exact);
    EXPECT_LE(found, exact * 17.0 / 16.0);
  }
  EXPECT_EQ(histogram.quantile(1.0).count(), sample.back());
  EXPECT_EQ(histogram.max().count(), sample.back());
  EXPECT_EQ(histogram.count(), 10000);
}

TEST(DurationHistogramTest, CountsOutliersInTheEndBins) {
  DurationHistogram histogram;
  EXPECT_EQ(histogram.quantile(0.5), Duration{0});
  histogram.record(Duration{-5});
  EXPECT_EQ(histogram.count_in(0), 1);
  histogram.record(std::chrono::hours{10});
  EXPECT_EQ(histogram.count_in(DurationHistogram::kBins - 1), 1);
  EXPECT_EQ(histogram.max(), Duration{std::chrono::hours{10}});
}

}  // namespace
}  // namespace hybridtest
