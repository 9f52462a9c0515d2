#include "runtime/wake_times.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "core/random.hpp"

namespace hybridtest {
namespace {

using std::chrono::nanoseconds;

/// Looks at all of them, one after the other.
std::vector<std::size_t> due_by_search(const std::vector<Instant>& times, Instant now) {
  std::vector<std::size_t> due;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (times[i] <= now) due.push_back(i);
  }
  return due;
}

TEST(WakeTimes, AreThoseOfASearchThroughAll) {
  Random random{1};
  for (const std::size_t count : {1U, 2U, 3U, 8U, 33U, 1001U}) {
    WakeTimes wakes{count};
    std::vector<Instant> times(count, kNever);
    EXPECT_EQ(wakes.earliest(), kNever);
    EXPECT_EQ(wakes.first(), 0U);
    std::vector<std::size_t> due;
    for (int change = 0; change < 500; ++change) {
      const std::size_t which = random.below(count);
      // Few different times, so that several are the same.
      times[which] = random.below(8) == 0 ? kNever : Instant{nanoseconds{random.below(50)}};
      wakes.set(which, times[which]);
      const auto first = std::ranges::min_element(times);
      ASSERT_EQ(wakes.earliest(), *first);
      ASSERT_EQ(wakes.first(), static_cast<std::size_t>(first - times.begin()));
      ASSERT_EQ(wakes.at(which), times[which]);
      const Instant now{nanoseconds{random.below(50)}};
      wakes.find_due(now, due);
      ASSERT_EQ(due, due_by_search(times, now)) << count;
    }
  }
}

}  // namespace
}  // namespace hybridtest
