#include "plant/transfer_systems/delay_line.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

using namespace std::chrono_literals;

TEST(DelayLine, ReturnsValueOfWholeIntervalsAgo) {
  DelayLine line{3ms, 1ms};
  EXPECT_EQ(line.corner_fraction(), 0.0);
  for (int i = 0; i < 20; ++i) {
    line.push(i + 1.0);
    EXPECT_EQ(line.delayed(), i < 3 ? 0.0 : i + 1.0 - 3.0);
    EXPECT_EQ(line.corner(), i < 4 ? 0.0 : i + 1.0 - 4.0);
  }
}

TEST(DelayLine, InterpolatesLinearly) {
  DelayLine line{2250us, 1ms};
  EXPECT_DOUBLE_EQ(line.corner_fraction(), 0.25);
  line.push(8.0);
  line.push(-4.0);
  EXPECT_EQ(line.delayed(), 0.0);
  line.push(0.0);
  EXPECT_DOUBLE_EQ(line.delayed(), 0.75 * 8.0);
  line.push(0.0);
  EXPECT_DOUBLE_EQ(line.delayed(), 0.25 * 8.0 - 0.75 * 4.0);
  EXPECT_DOUBLE_EQ(line.corner(), 8.0);
}

TEST(DelayLine, PassesACubicThroughFourSamples) {
  const auto cubic = [](double t) { return 1.0 + t * (2.0 + t * (-3.0 + 0.5 * t)); };
  const auto parabola = [](double t) { return 1.0 + t * (2.0 - 3.0 * t); };
  DelayLine line{2250us, 1ms};
  DelayLine within_first{250us, 1ms};
  for (int i = 0; i < 10; ++i) {
    line.push(cubic(i));
    within_first.push(parabola(i));
    if (i < 4) continue;
    EXPECT_NEAR(line.delayed_smoothly(), cubic(i - 2.25), 1e-12);
    EXPECT_NEAR(within_first.delayed_smoothly(), parabola(i - 0.25), 1e-12);
  }
  DelayLine whole{3ms, 1ms};
  for (int i = 0; i < 9; ++i) whole.push(0.1 * i);
  EXPECT_EQ(whole.delayed_smoothly(), 0.1 * 5) << "to the last bit";
}

TEST(DelayLine, ZeroDelayPassesAtOnce) {
  DelayLine line{0ms, 1ms};
  line.push(2.5);
  EXPECT_EQ(line.delayed(), 2.5);
}

TEST(DelayLine, ResetSetsZero) {
  DelayLine line{2ms, 1ms};
  for (int i = 0; i < 5; ++i) line.push(1.0);
  line.reset();
  line.push(7.0);
  EXPECT_EQ(line.delayed(), 0.0);
  line.push(8.0);
  EXPECT_EQ(line.delayed(), 0.0);
  line.push(9.0);
  EXPECT_EQ(line.delayed(), 7.0);
}

TEST(DelayLine, RejectsParametersOutOfRange) {
  EXPECT_THROW((DelayLine{-1ms, 1ms}), ConfigError);
  EXPECT_THROW((DelayLine{1ms, 0ms}), ConfigError);
  EXPECT_NO_THROW((DelayLine{100s, 1ms}));
  EXPECT_THROW((DelayLine{101s, 1ms}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
