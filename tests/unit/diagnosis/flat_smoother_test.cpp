#include "diagnosis/signals/flat_smoother.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "core/random.hpp"

namespace hybridtest {
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
