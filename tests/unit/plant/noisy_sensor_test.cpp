#include "plant/sensors/noisy_sensor.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

TEST(NoisySensor, ZeroNoiseReturnsTheValue) {
  NoisySensor sensor{0.0, Random{1}};
  for (const double value : {0.0, 0.25, -3.0e5}) EXPECT_EQ(sensor.read(value), value);
}

TEST(NoisySensor, NoiseHasStandardDeviationAndZeroMean) {
  constexpr int kReadings = 100'000;
  constexpr double kNoise = 50.0;
  NoisySensor sensor{kNoise, Random{7, 3}};
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kReadings; ++i) {
    const double noise = sensor.read(1000.0) - 1000.0;
    sum += noise;
    squares += noise * noise;
  }
  // Four standard errors: sigma / sqrt(N) of the mean, sigma / sqrt(2 N) of the deviation.
  EXPECT_NEAR(sum / kReadings, 0.0, 4.0 * kNoise / std::sqrt(kReadings));
  EXPECT_NEAR(std::sqrt(squares / kReadings), kNoise, 4.0 * kNoise / std::sqrt(2.0 * kReadings));
}

TEST(NoisySensor, RepeatsForSeedAndDiffersByStream) {
  NoisySensor sensor{1.0, Random{7, 0}};
  NoisySensor same{1.0, Random{7, 0}};
  NoisySensor other{1.0, Random{7, 1}};
  NoisySensor louder{2.0, Random{7, 0}};
  const double first = sensor.read(0.0);
  EXPECT_EQ(same.read(0.0), first);
  EXPECT_NE(other.read(0.0), first);
  EXPECT_EQ(louder.read(0.0), 2.0 * first);
  EXPECT_NE(sensor.read(0.0), first);
  sensor.reset();
  EXPECT_EQ(sensor.read(0.0), first);
}

TEST(NoisySensor, RejectsNoiseOutOfRange) {
  EXPECT_THROW((NoisySensor{-1.0, Random{1}}), ConfigError);
  EXPECT_THROW((NoisySensor{std::nan(""), Random{1}}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
