#include "core/spsc_ring.hpp"

#include <gtest/gtest.h>

namespace hybridtest {
namespace {

TEST(SpscRing, PopsInOrderOfPushing) {
  SpscRing<int> ring{3};
  EXPECT_TRUE(ring.push(1));
  EXPECT_TRUE(ring.push(2));
  int value = 0;
  EXPECT_TRUE(ring.pop(value));
  EXPECT_EQ(value, 1);
  EXPECT_TRUE(ring.pop(value));
  EXPECT_EQ(value, 2);
}

TEST(SpscRing, PopFromEmptyLeavesValueUnchanged) {
  SpscRing<int> ring{2};
  int value = 42;
  EXPECT_FALSE(ring.pop(value));
  EXPECT_EQ(value, 42);
}

TEST(SpscRing, RejectsPushBeyondCapacity) {
  SpscRing<int> ring{3};
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(ring.push(i));
  EXPECT_FALSE(ring.push(99));
  int value = -1;
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(ring.pop(value));
    EXPECT_EQ(value, i);
  }
  EXPECT_FALSE(ring.pop(value));
}

TEST(SpscRing, AcceptsPushAfterPop) {
  SpscRing<int> ring{1};
  int value = 0;
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(ring.push(i));
    EXPECT_FALSE(ring.push(-1));
    EXPECT_TRUE(ring.pop(value));
    EXPECT_EQ(value, i);
  }
}

TEST(SpscRing, KeepsOrderAcrossWrapAroundAtEveryFillLevel) {
  constexpr int kCapacity = 5;
  for (int level = 1; level <= kCapacity; ++level) {
    SpscRing<int> ring{kCapacity};
    int pushed = 0;
    for (; pushed < level; ++pushed) ASSERT_TRUE(ring.push(pushed));
    for (int taken = 0; taken < 100; ++taken) {
      int value = -1;
      ASSERT_TRUE(ring.pop(value));
      ASSERT_EQ(value, taken);
      ASSERT_TRUE(ring.push(pushed++));
    }
  }
}

}  // namespace
}  // namespace hybridtest
