#include "recording/row_ring.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <vector>

#include "recording/event_ring.hpp"
#include "tests/support/allocation_count.hpp"

namespace hybridtest {
namespace {

TEST(RowRing, KeepsOrderAcrossWrapAround) {
  RowRing ring{2, 3};
  double next_in = 0.0;
  double next_out = 0.0;
  for (int round = 0; round < 5; ++round) {
    for (int i = 0; i < 2; ++i, next_in += 1.0) ring.append(std::array{next_in, -next_in});
    std::array<double, 6> rows{};
    ASSERT_EQ(ring.take(rows), 2U);
    for (std::size_t i = 0; i < 2; ++i, next_out += 1.0) {
      EXPECT_EQ(rows[2 * i], next_out);
      EXPECT_EQ(rows[2 * i + 1], -next_out);
    }
  }
  EXPECT_EQ(ring.dropped(), 0U);
}

TEST(RowRing, TakesNoMoreRowsThanFit) {
  RowRing ring{1, 4};
  for (double value = 0.0; value < 4.0; value += 1.0) ring.append(std::array{value});
  std::array<double, 3> rows{};
  EXPECT_EQ(ring.take(rows), 3U);
  EXPECT_EQ(ring.size(), 1U);
  EXPECT_EQ(ring.take(rows), 1U);
  EXPECT_EQ(rows[0], 3.0);
  EXPECT_EQ(ring.take(rows), 0U);
}

TEST(RowRing, CountsRowsDroppedWhenFullAndKeepsOlder) {
  RowRing ring{1, 3};
  for (double value = 0.0; value < 8.0; value += 1.0) ring.append(std::array{value});
  EXPECT_EQ(ring.dropped(), 5U);
  std::array<double, 8> rows{};
  ASSERT_EQ(ring.take(rows), 3U);
  EXPECT_EQ(rows[2], 2.0);
  ring.append(std::array{9.0});
  EXPECT_EQ(ring.dropped(), 5U) << "there was room again";
}

TEST(RowRing, DoesNotAllocateWhenAppendingKeepingOrDropping) {
  RowRing ring{4, 8};
  EventRing events{2};
  const std::array<double, 4> row{1.0, 2.0, 3.0, 4.0};
  const Event event;
  const std::size_t before = allocation_count();
  for (int i = 0; i < 20; ++i) ring.append(row);
  for (int i = 0; i < 4; ++i) (void)events.send(event);
  EXPECT_EQ(allocation_count(), before);
  EXPECT_EQ(ring.dropped(), 12U);
  EXPECT_EQ(events.dropped(), 2U);
}

TEST(RowRing, ControlAllocationCountDetectsAllocation) {
  const std::size_t before = allocation_count();
  const auto vector = std::make_unique<std::vector<double>>(100);
  EXPECT_EQ(allocation_count(), before + 2) << vector->size();
}

TEST(RowRingDeathTest, WrongRowWidthAborts) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  RowRing ring{2, 2};
  EXPECT_DEATH(ring.append(std::array{1.0}), "row_width_");
}

}  // namespace
}  // namespace hybridtest
