#include "core/signal/frequency_evaluation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/random.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 0.001;

std::vector<double> sine(double frequency_hz, double amplitude, double delay_s, std::size_t count,
                         double offset = 0.0) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) {
    const double time_s = static_cast<double>(i) * kPeriod_s - delay_s;
    values.push_back(offset + amplitude * std::sin(2.0 * std::numbers::pi * frequency_hz * time_s));
  }
  return values;
}

struct Case {
  double frequency_hz, amplitude, delay_s;
};

class DelayedSine : public testing::TestWithParam<Case> {};

// The taper makes a sine's side lobes fall with the cube of the distance in frequency. What is left
// at zero frequency, where the negative frequencies' lobes overlap, is for the slowest sine here
// (two periods in each taper) below 1e-6 of the power and enters amplitude and phase once.
TEST_P(DelayedSine, RecoversAmplitudeAndFractionalDelay) {
  const Case& c = GetParam();
  constexpr std::size_t kSamples = 10'300;
  const auto result =
      evaluate_tracking_frequency(sine(c.frequency_hz, 0.02, 0.0, kSamples),
                                  sine(c.frequency_hz, 0.02 * c.amplitude, c.delay_s, kSamples, 0.003), kPeriod_s);
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->amplitude, c.amplitude, 5e-6 * c.amplitude);
  EXPECT_NEAR(result->frequency_hz, c.frequency_hz, 2e-4 * c.frequency_hz);
  EXPECT_NEAR(result->delay_s, c.delay_s, 5e-7);
  EXPECT_GT(result->coherence, 0.9999);
}

INSTANTIATE_TEST_SUITE_P(Closed, DelayedSine,
                         testing::Values(Case{2.0, 1.0, 0.0}, Case{2.0, 0.9, 0.0204}, Case{2.13, 1.2, 0.00037},
                                         Case{3.3, 1.0, -0.0081}, Case{17.7, 0.5, 0.0123}));

TEST(FrequencyEvaluation, DelayedNarrowBandMotionHasItsDelay) {
  // 1.9 to 2.1 Hz: the spread of (2π f delay) around its mean is 1 %, of which only the square enters.
  auto target = sine(1.9, 1.0, 0.0, 20'000);
  auto measured = sine(1.9, 1.0, 0.015, 20'000);
  const auto second_target = sine(2.1, 0.7, 0.0, 20'000);
  const auto second_measured = sine(2.1, 0.7, 0.015, 20'000);
  for (std::size_t i = 0; i < target.size(); ++i) {
    target[i] += second_target[i];
    measured[i] += second_measured[i];
  }
  const auto result = evaluate_tracking_frequency(target, measured, kPeriod_s);
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->delay_s, 0.015, 1e-4);
}

TEST(FrequencyEvaluation, UninformativeMotionsHaveNoDelay) {
  const std::vector<double> rest(1000, 0.01);
  const auto motion = sine(2.0, 0.01, 0.0, 1000);
  EXPECT_FALSE(evaluate_tracking_frequency(rest, motion, kPeriod_s).has_value());
  EXPECT_FALSE(evaluate_tracking_frequency(motion, rest, kPeriod_s).has_value());
  const std::span few = std::span{motion}.first(15);
  EXPECT_FALSE(evaluate_tracking_frequency(few, few, kPeriod_s).has_value());
}

TEST(FrequencyEvaluation, NoiseAroundSmallMotionHasNoDelay) {
  Random random{5};
  std::vector<double> noise(4000);
  for (double& value : noise) value = 1e-5 * random.normal();
  for (const double amplitude_m : {1e-7, 1e-3}) {
    const auto target = sine(2.0, amplitude_m, 0.0, noise.size());
    auto measured = sine(2.0, amplitude_m, 0.01, noise.size());
    for (std::size_t i = 0; i < noise.size(); ++i) measured[i] += noise[i];
    EXPECT_EQ(evaluate_tracking_frequency(target, measured, kPeriod_s).has_value(), amplitude_m > 1e-4);
  }
}

TEST(FrequencyEvaluation, SumOverBlocksRecoversAmplitudeAndDelay) {
  constexpr std::size_t kBlock = 8192;
  const auto target = sine(3.3, 0.02, 0.0, 10 * kBlock);
  const auto measured = sine(3.3, 0.018, 0.0204, 10 * kBlock, 0.003);
  FrequencyEvaluationSum sum{kPeriod_s, kBlock};
  for (std::size_t first = 0; first < target.size(); first += kBlock) {
    sum.add(std::span{target}.subspan(first, kBlock), std::span{measured}.subspan(first, kBlock));
  }
  const auto result = sum.result();
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->amplitude, 0.9, 1e-5);
  EXPECT_NEAR(result->frequency_hz, 3.3, 1e-3);
  EXPECT_NEAR(result->delay_s, 0.0204, 1e-6);
}

TEST(FrequencyEvaluation, SumOverBlocksCountsRestingBlocksOut) {
  constexpr std::size_t kBlock = 8192;
  const auto target = sine(3.3, 0.02, 0.0, kBlock);
  const auto measured = sine(3.3, 0.018, 0.0204, kBlock);
  const std::vector<double> rest(kBlock, 0.01);
  FrequencyEvaluationSum alone{kPeriod_s, kBlock};
  alone.add(target, measured);
  FrequencyEvaluationSum with_rest{kPeriod_s, kBlock};
  with_rest.add(rest, rest);
  with_rest.add(target, measured);
  EXPECT_EQ(with_rest.result().value().delay_s, alone.result().value().delay_s);
  FrequencyEvaluationSum only_rest{kPeriod_s, kBlock};
  only_rest.add(rest, rest);
  EXPECT_FALSE(only_rest.result().has_value());
}

}  // namespace
}  // namespace hybridtest
