#include "diagnosis/signals/noise_parts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "diagnosis/signals/signals.hpp"
#include "tests/unit/diagnosis/made_noise.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 0.001;
constexpr std::size_t kCount = 6000;
constexpr std::uint64_t kDraws = 24;

/// White noise of this root mean square beside autoregressive noise of another.
struct Parts {
  double white = 0.0;
  double coloured = 0.0;
  double correlation = 0.0;  // of neighbouring samples

  [[nodiscard]] std::vector<double> drawn(std::uint64_t draw) const {
    std::vector<double> values = made_noise({}, kCount, white, kPeriod_s, 2 * draw);
    const std::vector<double> beside =
        made_noise({.correlation = correlation}, kCount, coloured, kPeriod_s, 2 * draw + 1);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += beside[i];
    return values;
  }
  /// Power at low frequencies, per sample: what moves a structure.
  [[nodiscard]] double slow_power() const {
    return white * white + coloured * coloured * (1.0 + correlation) / (1.0 - correlation);
  }
};

Parts told(const std::vector<double>& values) {
  const NoiseParts parts = noise_parts(values, kPeriod_s);
  const double correlation = parts.coloured > 0.0 ? std::exp(-kPeriod_s / parts.correlation_time_s) : 0.0;
  return {parts.white, parts.coloured, correlation};
}

TEST(NoiseParts, WhiteNoiseHasNoColouredPart) {
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    const Parts parts = told(Parts{.white = 3.0}.drawn(draw));
    EXPECT_EQ(parts.coloured, 0.0) << draw;
    EXPECT_NEAR(parts.white, 3.0, 0.15) << draw;
  }
}

// The median of the draws; one draw of 6 s knows slow noise worse.
TEST(NoiseParts, TellsBothPartsOfColouredNoise) {
  for (const Parts& real : {Parts{0.0, 1.0, 0.6}, Parts{0.0, 1.0, 0.9}, Parts{0.0, 1.0, 0.97}, Parts{1.0, 1.0, 0.9},
                            Parts{1.0, 0.5, 0.9}, Parts{1.0, 0.3, 0.95}}) {
    std::vector<double> white;
    std::vector<double> coloured;
    std::vector<double> slow;
    for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
      const Parts parts = told(real.drawn(draw));
      white.push_back(parts.white);
      coloured.push_back(parts.coloured);
      slow.push_back(parts.slow_power() / real.slow_power());
    }
    const std::string of = testing::PrintToString(std::vector{real.white, real.coloured, real.correlation});
    EXPECT_NEAR(upper_median(white), real.white, 0.15) << of;
    EXPECT_NEAR(upper_median(coloured), real.coloured, 0.1 * real.coloured) << of;
    EXPECT_NEAR(upper_median(slow), 1.0, 0.25) << of;
  }
}

// A misfit that is smooth, or hum, is no noise of this kind.
TEST(NoiseParts, TakesNeitherSlowMisfitNorHum) {
  for (const double frequency_hz : {1.5, 50.0}) {
    for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
      std::vector<double> values = Parts{.white = 1.0}.drawn(draw);
      for (std::size_t i = 0; i < values.size(); ++i) {
        const double time_s = kPeriod_s * static_cast<double>(i);
        values[i] += std::numbers::sqrt2 * std::sin(2.0 * std::numbers::pi * frequency_hz * time_s);
      }
      EXPECT_EQ(noise_parts(values, kPeriod_s).coloured, 0.0) << frequency_hz << " Hz, " << draw;
    }
  }
}

TEST(NoiseParts, NothingIsToldOfTooFewSamples) {
  EXPECT_EQ(noise_parts({}, kPeriod_s).coloured, 0.0);
  EXPECT_EQ(noise_parts(std::vector<double>(40, 1.0), kPeriod_s).coloured, 0.0);
  EXPECT_EQ(noise_parts(std::vector<double>(6000, 0.0), kPeriod_s).coloured, 0.0);
}

}  // namespace
}  // namespace hybridtest
