#include "recording/summary/ranked_values.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/random.hpp"
#include "recording/summary/percentiles.hpp"

namespace hybridtest {
namespace {

struct Ranked {
  std::vector<double> values;
  int passes = 0;
};

Ranked ranked(const std::vector<double>& values, const std::vector<std::size_t>& ranks) {
  RankedValues search{[&](std::size_t count) {
    EXPECT_EQ(count, values.size());
    return ranks;
  }};
  Ranked result;
  do {
    for (const double value : values) search.add(value);
    ++result.passes;
  } while (search.end_pass());
  result.values = search.values();
  return result;
}

/// The standard library's sort is the reference.
std::vector<double> sorted_at(std::vector<double> values, const std::vector<std::size_t>& ranks) {
  std::ranges::sort(values);
  std::vector<double> at;
  for (const std::size_t rank : ranks) at.push_back(values[rank]);
  return at;
}

TEST(RankedValues, EqualThoseOfSortingAllValues) {
  Random random{5, 1};
  std::vector<double> values;
  for (int i = 0; i < 60'000; ++i) {
    const double magnitude = std::pow(10.0, random.uniform(-12.0, 12.0));
    values.push_back(random.uniform(-1.0, 1.0) < 0.0 ? -magnitude : magnitude);
  }
  const std::vector<std::size_t> ranks{0, 1, 599, 30'000, 30'001, 59'400, 59'999};
  EXPECT_EQ(ranked(values, ranks).values, sorted_at(values, ranks));
}

TEST(RankedValues, FindThemAmongValuesOfTheLastBitsAlone) {
  std::vector<double> values;
  double value = 1.0;
  for (int i = 0; i < 60'000; ++i) values.push_back(value = std::nextafter(value, 2.0));
  Random random{5, 2};
  for (std::size_t i = values.size() - 1; i > 0; --i) std::swap(values[i], values[random.below(i + 1)]);
  const std::vector<std::size_t> ranks{0, 29'999, 59'999};
  const Ranked result = ranked(values, ranks);
  EXPECT_EQ(result.values, sorted_at(values, ranks));
  EXPECT_GE(result.passes, 4);
  EXPECT_LE(result.passes, 6) << "12 of 64 bits each";
}

TEST(RankedValues, OfFewDifferingValuesNeedOnePass) {
  std::vector<double> values;
  for (int i = 0; i < 60'000; ++i) values.push_back(i % 2000 == 0 ? -1.0 : 0.25 * (i % 700));
  const std::vector<std::size_t> ranks{0, 100, 59'999};
  const Ranked result = ranked(values, ranks);
  EXPECT_EQ(result.values, sorted_at(values, ranks));
  EXPECT_EQ(result.passes, 1);
}

TEST(RankedValues, OfNoValueAreNone) {
  RankedValues search{[](std::size_t) { return std::vector<std::size_t>{0}; }};
  EXPECT_FALSE(search.end_pass());
  EXPECT_TRUE(search.values().empty());
}

TEST(RankedValues, PercentilesOfManyValuesUseNearestRank) {
  std::vector<double> values;
  for (int i = 0; i < 50'000; ++i) values.push_back(1e-3 * ((i * 7919) % 50'000 + 1));
  values.push_back(std::numeric_limits<double>::quiet_NaN());
  const auto result = percentiles(values);
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->p50, 1e-3 * 25'000);
  EXPECT_EQ(result->p99, 1e-3 * 49'500);
  EXPECT_EQ(result->max, 1e-3 * 50'000);
}

}  // namespace
}  // namespace hybridtest
