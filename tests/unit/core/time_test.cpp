#include "core/time.hpp"

#include <gtest/gtest.h>

namespace hybridtest {
namespace {

template <class Clock>
concept Readable = requires {
  Clock::now();
};

// The control beside the guard: a clock that can be read is told apart.
static_assert(Readable<std::chrono::steady_clock>);
static_assert(!Readable<HandedClock>);

// Instants of the wall clock do not pass for handed ones.
static_assert(!std::is_convertible_v<std::chrono::steady_clock::time_point, Instant>);

TEST(Time, SecondsRoundToNearestNanosecond) {
  EXPECT_EQ(from_seconds(0.0).count(), 0);
  EXPECT_EQ(from_seconds(1.0).count(), 1'000'000'000);
  EXPECT_EQ(from_seconds(0.001).count(), 1'000'000);
  EXPECT_EQ(from_seconds(1.4e-9).count(), 1);
  EXPECT_EQ(from_seconds(1.6e-9).count(), 2);
}

TEST(Time, NegativeSecondsRoundLikePositive) {
  EXPECT_EQ(from_seconds(-1.4e-9).count(), -1);
  EXPECT_EQ(from_seconds(-1.6e-9).count(), -2);
  EXPECT_EQ(from_seconds(-31.0), -from_seconds(31.0));
}

TEST(Time, MillisecondsOfALongTestAreExact) {
  // One rounding of k * 0.001 and one of the product with 1e9 stay below half a nanosecond up to 1e5 s.
  for (std::int64_t k = 0; k <= 100'000'000; k += 99'991)
    ASSERT_EQ(from_seconds(static_cast<double>(k) * 0.001).count(), k * 1'000'000);
}

TEST(Time, NanosecondsRoundTripThroughSeconds) {
  for (const std::int64_t count : {std::int64_t{1}, std::int64_t{999'999'999}, std::int64_t{123'456'789'012'345}})
    EXPECT_EQ(from_seconds(to_seconds(Duration{count})).count(), count);
  EXPECT_DOUBLE_EQ(to_seconds(std::chrono::milliseconds{1500}), 1.5);
}

TEST(Time, NeverIsLaterThanEveryInstant) {
  EXPECT_GT(kNever, Instant{from_seconds(9e9)});
  EXPECT_EQ(kNever, Instant::max());
}

}  // namespace
}  // namespace hybridtest
