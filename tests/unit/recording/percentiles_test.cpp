#include "recording/summary/percentiles.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace hybridtest {
namespace {

TEST(Percentiles, UseNearestRank) {
  std::vector<double> values;
  for (int i = 200; i >= 1; --i) values.push_back(i);
  const auto result = percentiles(values);
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->p50, 100.0);
  EXPECT_EQ(result->p99, 198.0);
  EXPECT_EQ(result->max, 200.0);
}

TEST(Percentiles, OfOneValueAndOfNone) {
  const auto one = percentiles({7.0, std::numeric_limits<double>::quiet_NaN()});
  ASSERT_TRUE(one.has_value());
  EXPECT_EQ(one->p50, 7.0);
  EXPECT_EQ(one->p99, 7.0);
  EXPECT_FALSE(percentiles({}).has_value());
}

}  // namespace
}  // namespace hybridtest
