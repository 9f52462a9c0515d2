#include "validation/design_motion/filtered_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace hybridtest::design_motion {
namespace {

TEST(Envelope, RisesHoldsDecaysAndFades) {
  const Envelope envelope;
  EXPECT_EQ(envelope.at(0.0), 0.0);
  EXPECT_DOUBLE_EQ(envelope.at(1.5), 0.25);
  EXPECT_EQ(envelope.at(3.0), 1.0);
  EXPECT_EQ(envelope.at(15.0), 1.0);
  EXPECT_DOUBLE_EQ(envelope.at(19.0), std::exp(-1.0));
  EXPECT_DOUBLE_EQ(envelope.at(30.5), 0.5 * std::exp(-0.25 * 15.5));
  EXPECT_EQ(envelope.at(31.0), 0.0);
}

/// Transfer function of both filters from the rock to the ground's acceleration.
double gain(const GroundFilter& filter, double omega) {
  using Complex = std::complex<double>;
  const auto stiffness = [omega](double frequency, double ratio) {
    return Complex{frequency * frequency, 2.0 * ratio * frequency * omega};
  };
  const Complex soil = stiffness(filter.soil_frequency_rad_per_s, filter.soil_damping_ratio);
  const Complex high_pass = stiffness(filter.high_pass_frequency_rad_per_s, filter.high_pass_damping_ratio);
  const double square = omega * omega;
  return std::abs(soil / (soil - square)) * std::abs(square / (high_pass - square));
}

TEST(FilteredNoise, HasTheVarianceOfItsSpectrum) {
  constexpr double kStep_s = 0.01;
  constexpr std::size_t kCount = 400000;
  const GroundFilter filter;
  const Envelope steady{.rise_s = 1e-9, .strong_end_s = 1e9, .decay_per_s = 0.0, .end_s = 1e9, .fade_s = 1e-9};
  Random random{3};
  double square = 0.0;
  for (const double value : filtered_noise(random, filter, steady, kStep_s, kCount)) square += value * value;
  // Unit normal numbers, straight in between: power dt/2pi (sin(x)/x)^4 with x = w dt/2.
  double expected = 0.0;
  constexpr double kWidth = 0.01;
  for (double omega = 0.5 * kWidth; omega < 2000.0; omega += kWidth) {
    const double x = 0.5 * omega * kStep_s;
    const double straight = std::pow(std::sin(x) / x, 4);
    expected += 2.0 * kWidth * kStep_s / (2.0 * std::numbers::pi) * straight * std::pow(gain(filter, omega), 2);
  }
  // 4000 s of noise about 15 rad/s wide: some 20000 independent values, so 1 % is one standard error.
  EXPECT_NEAR(square / static_cast<double>(kCount) / expected, 1.0, 0.04);
}

TEST(FilteredNoise, RepeatsForASeed) {
  Random first{5};
  Random again{5};
  Random other{6};
  const auto motion = filtered_noise(first, {}, {}, 0.01, 1000);
  EXPECT_EQ(motion, filtered_noise(again, {}, {}, 0.01, 1000));
  EXPECT_NE(motion, filtered_noise(other, {}, {}, 0.01, 1000));
}

}  // namespace
}  // namespace hybridtest::design_motion
