#include "transport/bounded_queue.hpp"

#include <gtest/gtest.h>

namespace hybridtest {
namespace {

TEST(BoundedQueue, KeepsOrderAcrossWrapAround) {
  BoundedQueue<int> queue{3};
  int value = 0;
  int next_in = 0;
  int next_out = 0;
  for (int round = 0; round < 10; ++round) {
    for (int i = 0; i < 2; ++i) ASSERT_TRUE(queue.push(next_in++));
    for (int i = 0; i < 2; ++i) {
      ASSERT_TRUE(queue.pop(value));
      ASSERT_EQ(value, next_out++);
    }
  }
}

TEST(BoundedQueue, PopFromEmptyLeavesValueUnchanged) {
  BoundedQueue<int> queue{1};
  int value = 5;
  EXPECT_FALSE(queue.pop(value));
  EXPECT_EQ(value, 5);
}

TEST(BoundedQueue, RejectsAndCountsWhenFull) {
  BoundedQueue<int> queue{2};
  EXPECT_TRUE(queue.push(1));
  EXPECT_TRUE(queue.push(2));
  EXPECT_FALSE(queue.push(3));
  EXPECT_FALSE(queue.push(4));
  EXPECT_EQ(queue.turned_away(), 2U);
  int value = 0;
  EXPECT_TRUE(queue.pop(value));
  EXPECT_EQ(value, 1);
  EXPECT_TRUE(queue.push(5));
  EXPECT_TRUE(queue.pop(value));
  EXPECT_EQ(value, 2);
  EXPECT_TRUE(queue.pop(value));
  EXPECT_EQ(value, 5);
  EXPECT_FALSE(queue.pop(value));
}

TEST(BoundedQueue, DisplacingDropsOldestAndCounts) {
  BoundedQueue<int> queue{2};
  queue.push_displacing(1);
  queue.push_displacing(2);
  EXPECT_EQ(queue.turned_away(), 0U);
  queue.push_displacing(3);
  EXPECT_EQ(queue.turned_away(), 1U);
  int value = 0;
  EXPECT_TRUE(queue.pop(value));
  EXPECT_EQ(value, 2);
  EXPECT_TRUE(queue.pop(value));
  EXPECT_EQ(value, 3);
  EXPECT_FALSE(queue.pop(value));
}

}  // namespace
}  // namespace hybridtest
