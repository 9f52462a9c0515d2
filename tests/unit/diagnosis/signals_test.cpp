#include "diagnosis/signals/signals.hpp"

#include <gtest/gtest.h>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/random.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 0.001;

std::vector<double> white_noise(std::size_t samples, double deviation) {
  Random random{17};
  std::vector<double> values(samples);
  for (double& value : values) value = deviation * random.normal();
  return values;
}

TEST(LocalPolynomial, IsExactForAQuarticUpToBothEnds) {
  std::vector<double> displacement_m;
  for (int i = 0; i < 60; ++i) displacement_m.push_back(2.0 - i + 0.5 * std::pow(0.1 * i, 4));
  const auto motion = LocalPolynomial{7, 1.0}.motion(displacement_m);
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const double t = static_cast<double>(i);
    // Rounding of values of 1e3 through fifteen weights.
    EXPECT_NEAR(motion[i].displacement_m, displacement_m[i], 1e-9) << i;
    EXPECT_NEAR(motion[i].velocity_m_per_s, -1.0 + 0.2 * std::pow(0.1 * t, 3), 1e-9) << i;
    EXPECT_NEAR(motion[i].acceleration_m_per_s2, 0.06 * std::pow(0.1 * t, 2), 1e-9) << i;
  }
}

TEST(LocalPolynomial, PassesItsStatedNoiseShare) {
  const auto noise = white_noise(200000, 1.0);
  const LocalPolynomial polynomial{10, kPeriod_s};
  double squares = 0.0;
  for (const double value : polynomial.smooth(noise)) squares += value * value;
  // Of 200 000 samples that hang together over 21 the variance is known to about 2 %: three times that.
  EXPECT_NEAR(squares / 200000.0, polynomial.noise_share(), 0.06 * polynomial.noise_share());
}

TEST(WhiteNoiseLevel, MatchesNoiseOnSlowMotion) {
  std::vector<double> values = white_noise(20000, 2e-5);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] += 0.03 * std::sin(2.0 * std::numbers::pi * 1.5 * kPeriod_s * static_cast<double>(i));
  }
  EXPECT_NEAR(white_noise_level(values), 2e-5, 0.03 * 2e-5);  // 1 / sqrt(2 N), and the window's own correlation
}

TEST(WhiteNoiseLevel, TypicalOneDoesNotCountJumps) {
  std::vector<double> values = white_noise(20000, 2.0);
  // A dry friction of 500 N that turns round every 500 samples.
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += i / 500 % 2 == 0 ? 500.0 : -500.0;
  // The deviation of a median of 20 000 magnitudes is 0.8 %. The seven samples about each jump are 1.4 %, which moves
  // it by 1.7 %.
  EXPECT_NEAR(typical_white_noise(values), 2.0 * 1.017, 0.05);
  EXPECT_GT(white_noise_level(values), 10.0) << "control";
  EXPECT_NEAR(typical_white_noise(white_noise(20000, 2.0)), 2.0, 0.05);
  EXPECT_EQ(typical_white_noise(std::vector<double>(100, 7.0)), 0.0);
}

TEST(WidestFaithfulHalfWidth, IsLimitedByTheMotion) {
  const auto noisy_sine = [](double frequency_hz) {
    std::vector<double> values = white_noise(4000, 1e-5);
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] += 0.01 * std::sin(2.0 * std::numbers::pi * frequency_hz * kPeriod_s * static_cast<double>(i));
    }
    return values;
  };
  EXPECT_EQ(widest_faithful_half_width(noisy_sine(1.0)), 40U);
  // Over 40 samples either way a 20 Hz sine is five cycles, which no quartic follows.
  EXPECT_LT(widest_faithful_half_width(noisy_sine(20.0)), 14U);
}

}  // namespace

namespace {

TEST(FlatSmoother, AttenuatesSineByItsGain) {
  const FlatSmoother smoother{4.0};
  const double per_sample = 2.0 * std::numbers::pi * 0.04;
  std::vector<double> sine;
  for (int i = 0; i < 400; ++i) sine.push_back(std::sin(per_sample * i));
  const std::vector<double> smooth = smoother.smooth(sine);
  const double gain = 1.0 - std::pow(1.0 - std::exp(-0.5 * std::pow(per_sample * 4.0, 2)), 3);
  EXPECT_GT(gain, 0.5);
  EXPECT_LT(gain, 0.95);
  // The weights beyond four deviations of the widest part, 6e-5 of them all.
  for (std::size_t i = smoother.reach(); i + smoother.reach() < sine.size(); ++i) {
    ASSERT_NEAR(smooth[i], gain * sine[i], 1e-4);
  }
}

TEST(FlatSmoother, KeepsConstantsAndItsStatedNoiseShare) {
  const FlatSmoother smoother{3.0};
  for (const double value : smoother.smooth(std::vector<double>(50, 2.5))) EXPECT_NEAR(value, 2.5, 1e-14);
  Random random{5};
  std::vector<double> noise(200'000);
  for (double& value : noise) value = random.normal();
  double squares = 0.0;
  for (const double value : smoother.smooth(noise)) squares += value * value / 200'000.0;
  // The sum of squared weights, 3 g - 3 g^2 + g^3, by the convolution of normal distributions; the estimate's own
  // deviation is about 1 % of it: three times.
  constexpr std::array kPowers{3.0, -3.0, 1.0};
  double share = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const double variance = 9.0 * static_cast<double>(i + j + 2);
      share += kPowers[i] * kPowers[j] / std::sqrt(2.0 * std::numbers::pi * variance);
    }
  }
  EXPECT_NEAR(smoother.noise_share(), share, 1e-4 * share);
  EXPECT_NEAR(squares, smoother.noise_share(), 0.03 * smoother.noise_share());
}

TEST(FlatSmoother, ZeroWidthChangesNothing) {
  const std::vector<double> values{1.0, -2.0, 4.0};
  EXPECT_EQ(FlatSmoother{0.0}.smooth(values), values);
  EXPECT_EQ(FlatSmoother{0.0}.noise_share(), 1.0);
}

}  // namespace

}  // namespace hybridtest
