#include "coordinator/excitation/generated_signal.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace hybridtest {
namespace {

TEST(HarmonicSignal, IsASineBetweenItsRamps) {
  const HarmonicSignal signal{.amplitude = 3.0, .frequency_hz = 2.0, .duration_s = 5.0, .ramp_s = 1.0};
  EXPECT_EQ(signal.at(-0.001), 0.0);
  EXPECT_EQ(signal.at(5.001), 0.0);
  EXPECT_NEAR(signal.at(2.125), 3.0, 1e-12);
  EXPECT_NEAR(signal.at(0.625), 3.0 * 0.5 * (1.0 - std::cos(0.625 * std::numbers::pi)), 1e-12) << "in the ramp";
  EXPECT_NEAR(signal.at(4.375), -3.0 * 0.5 * (1.0 - std::cos(0.625 * std::numbers::pi)), 1e-12) << "fading";
}

/// Rising crossings of zero in an interval.
int cycles(const SweepSignal& signal, double from_s, double to_s) {
  int count = 0;
  for (double t = from_s; t < to_s; t += 1e-4) count += signal.at(t) < 0.0 && signal.at(t + 1e-4) >= 0.0 ? 1 : 0;
  return count;
}

TEST(SweepSignal, LinearOnePassesTheMeanFrequency) {
  const SweepSignal signal{.amplitude = 1.0, .from_hz = 1.0, .to_hz = 9.0, .duration_s = 20.0};
  EXPECT_NEAR(cycles(signal, 0.0, 20.0), 100, 1) << "(1 + 9)/2 Hz over 20 s";
  EXPECT_NEAR(cycles(signal, 9.0, 11.0), 10, 1) << "5 Hz in the middle";
}

TEST(SweepSignal, LogarithmicOneGivesEachOctaveTheSameTime) {
  const SweepSignal signal{
      .amplitude = 1.0, .from_hz = 1.0, .to_hz = 16.0, .duration_s = 40.0, .type = SweepType::logarithmic};
  // Cycles of an octave from f in 10 s: f 10/ln 2 (2 - 1).
  EXPECT_NEAR(cycles(signal, 0.0, 10.0), 10.0 / std::numbers::ln2, 1.01);
  EXPECT_NEAR(cycles(signal, 30.0, 40.0), 80.0 / std::numbers::ln2, 1.01);
}

TEST(SweepSignal, MayGoDownAndMayStand) {
  const SweepSignal down{
      .amplitude = 1.0, .from_hz = 8.0, .to_hz = 2.0, .duration_s = 10.0, .type = SweepType::logarithmic};
  EXPECT_GT(cycles(down, 0.0, 1.0), 2 * cycles(down, 9.0, 10.0));
  const SweepSignal steady{
      .amplitude = 1.0, .from_hz = 3.0, .to_hz = 3.0, .duration_s = 10.0, .type = SweepType::logarithmic};
  EXPECT_NEAR(steady.at(1.0 / 12.0), 1.0, 1e-12);
}

}  // namespace
}  // namespace hybridtest
