#include "plant/sensors/noisy_sensor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

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

TEST(NoisySensor, WithoutColouredPartReadsAsWithWhiteAlone) {
  NoisySensor white{0.3, Random{7, 0}};
  NoisySensor both{0.3, Random{7, 0}, {.noise = 0.0, .correlation = 0.9, .random = Random{7, 1}}};
  NoisySensor quiet{0.0, Random{7, 0}};
  NoisySensor silent{0.0, Random{7, 0}, {}};
  for (int i = 0; i < 1000; ++i) {
    const double value = i % 3 - 1.0;
    EXPECT_EQ(both.read(value), white.read(value));
    EXPECT_EQ(std::signbit(silent.read(-0.0)), std::signbit(quiet.read(-0.0)));
  }
}

TEST(NoisySensor, WhitePartIsTheSameBesideColouredNoise) {
  const NoisySensor::Coloured coloured{.noise = 2.0, .correlation = 0.9, .random = Random{7, 1}};
  NoisySensor white{0.3, Random{7, 0}};
  NoisySensor alone{0.0, Random{7, 0}, coloured};
  NoisySensor both{0.3, Random{7, 0}, coloured};
  for (int i = 0; i < 1000; ++i) EXPECT_NEAR(both.read(0.0), white.read(0.0) + alone.read(0.0), 1e-14);
}

TEST(NoisySensor, ColouredNoiseHasItsVarianceAndCorrelation) {
  constexpr std::size_t kReadings = 200'000;
  constexpr double kNoise = 50.0;
  for (const double correlation : {0.0, 0.5, 0.9}) {
    NoisySensor sensor{0.0, Random{7, 0}, {.noise = kNoise, .correlation = correlation, .random = Random{7, 1}}};
    std::vector<double> noise;
    for (std::size_t i = 0; i < kReadings; ++i) noise.push_back(sensor.read(1000.0) - 1000.0);
    const auto product = [&](std::size_t lag) {
      double sum = 0.0;
      for (std::size_t i = lag; i < kReadings; ++i) sum += noise[i] * noise[i - lag];
      return sum / static_cast<double>(kReadings - lag);
    };
    // Four standard errors (Bartlett, 1946): of an autoregressive process the squares of the correlations add up to
    // (1 + r^2) / (1 - r^2); the variance has twice that, and each correlation at most that.
    const double squared = correlation * correlation;
    const double error = std::sqrt((1.0 + squared) / (1.0 - squared) / static_cast<double>(kReadings));
    EXPECT_NEAR(product(0) / (kNoise * kNoise), 1.0, 4.0 * std::sqrt(2.0) * error) << correlation;
    for (const std::size_t lag : {1, 2, 5, 10, 20}) {
      EXPECT_NEAR(product(lag) / product(0), std::pow(correlation, lag), 4.0 * error) << correlation << ", lag " << lag;
    }
  }
}

TEST(NoisySensor, ColouredNoiseIsStationaryFromTheFirstReading) {
  constexpr int kSensors = 20'000;
  double squares = 0.0;
  for (int i = 0; i < kSensors; ++i) {
    const auto stream = static_cast<std::uint64_t>(i);
    NoisySensor sensor{0.0, Random{7, 0}, {.noise = 3.0, .correlation = 0.99, .random = Random{8, stream}}};
    squares += std::pow(sensor.read(0.0), 2) / kSensors;
  }
  // Four standard errors.
  EXPECT_NEAR(squares / 9.0, 1.0, 4.0 * std::sqrt(2.0 / kSensors));
}

TEST(NoisySensor, ColouredNoiseRepeatsAfterReset) {
  NoisySensor sensor{0.3, Random{7, 0}, {.noise = 2.0, .correlation = 0.9, .random = Random{7, 1}}};
  std::vector<double> first;
  for (int i = 0; i < 5; ++i) first.push_back(sensor.read(0.0));
  sensor.reset();
  for (const double reading : first) EXPECT_EQ(sensor.read(0.0), reading);
}

TEST(NoisySensor, RejectsNoiseOutOfRange) {
  EXPECT_THROW((NoisySensor{-1.0, Random{1}}), ConfigError);
  EXPECT_THROW((NoisySensor{std::nan(""), Random{1}}), ConfigError);
  const auto make = [](double noise, double correlation) {
    NoisySensor{0.0, Random{1}, {.noise = noise, .correlation = correlation, .random = Random{2}}};
  };
  EXPECT_NO_THROW(make(1.0, 0.0));
  EXPECT_THROW(make(-1.0, 0.5), ConfigError);
  EXPECT_THROW(make(1.0, -0.1), ConfigError);
  EXPECT_THROW(make(1.0, 1.0), ConfigError);
}

}  // namespace
}  // namespace hybridtest
