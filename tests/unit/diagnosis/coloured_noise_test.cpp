#include "diagnosis/identification/coloured_noise.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "tests/unit/diagnosis/made_noise.hpp"

namespace hybridtest {
namespace {

TEST(IndependentSamples, FollowTheAutocorrelation) {
  for (const double correlation : {0.0, 0.9, 0.99}) {
    constexpr std::size_t kCount = 40'000;
    const std::vector<double> noise = made_noise({.correlation = correlation}, kCount, 1.0, 0.001, 3);
    const double exact = kCount * (1.0 - correlation) / (1.0 + correlation);
    // The sum over five times of N samples is known to sqrt(2 (2 * 5 + 1) time / N): 33 % at 200 samples (Sokal).
    EXPECT_NEAR(independent_samples(Eigen::Map<const Eigen::VectorXd>(noise.data(), kCount)), exact, 0.33 * exact);
  }
}

TEST(NoiseOfNeighbours, IsThatOfWhiteAndOfSlowNoise) {
  constexpr std::size_t kCount = 4'000;
  for (const double correlation : {0.0, 0.5, 0.8}) {
    std::vector<double> noise = made_noise({.correlation = correlation}, kCount, 0.8, 0.001, 3);
    const std::vector<double> white = made_noise({}, kCount, 0.6, 0.001, 4);
    for (std::size_t i = 0; i < kCount; ++i) noise[i] += white[i];
    // Of one, root mean square: 0.8 and 0.6. The growth of the differences is known to a tenth at 0.8.
    EXPECT_NEAR(noise_of_neighbours(Eigen::Map<const Eigen::VectorXd>(noise.data(), kCount)).value(), 1.0, 0.07)
        << correlation;
  }
}

/// What a law misses changes with the displacement, over a hundred samples from one reversal to the next.
TEST(NoiseOfNeighbours, IsNotToldBesideWhatALawMisses) {
  constexpr std::size_t kCount = 4'000;
  std::vector<double> values = made_noise({.correlation = 0.5}, kCount, 1.0, 0.001, 3);
  for (std::size_t i = 0; i < kCount; ++i)
    values[i] += 4.0 * std::sin(std::numbers::pi * static_cast<double>(i) / 50.0);
  EXPECT_FALSE(noise_of_neighbours(Eigen::Map<const Eigen::VectorXd>(values.data(), kCount)));
}

TEST(VariancesAlong, CountNeighboursThatGoTogether) {
  constexpr std::size_t kCount = 40'000;
  const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(kCount, 1);
  for (const double correlation : {0.0, 0.9}) {
    const std::vector<double> noise = made_noise({.correlation = correlation}, kCount, 1.0, 0.001, 3);
    const Eigen::Map<const Eigen::VectorXd> values{noise.data(), kCount};
    const double exact = kCount * (1.0 + correlation) / (1.0 - correlation);
    // As of independent samples: here 6 %, and Bartlett's weights take off a tenth.
    EXPECT_NEAR(ColouredNoise{values}.variances_along(ones)[0], exact, 0.25 * exact) << correlation;
  }
}

// Long correlations are summed by Fourier transforms, short ones product by product.
TEST(VariancesAlong, AreNeweyAndWestsForLongAndShortCorrelations) {
  constexpr Eigen::Index kCount = 3'000;
  for (const double correlation : {0.0, 0.99}) {
    const std::vector<double> noise = made_noise({.correlation = correlation}, kCount, 1.0, 0.001, 3);
    const Eigen::Map<const Eigen::VectorXd> values{noise.data(), kCount};
    const Eigen::VectorXd weights = Eigen::VectorXd::LinSpaced(kCount, 0.0, 20.0).array().sin().matrix();
    const auto product = [](const Eigen::VectorXd& signal, Eigen::Index lag) {
      double sum = 0.0;
      for (Eigen::Index i = lag; i < signal.size(); ++i) sum += signal[i] * signal[i - lag];
      return sum;
    };
    // Sokal's window: the first lag beyond five times the integrated time.
    double time = 1.0;
    Eigen::Index lags = 1;
    for (; lags < kCount && static_cast<double>(lags) <= 5.0 * time; ++lags) {
      time += 2.0 * product(values, lags) / product(values, 0);
    }
    double exact = product(values, 0) * product(weights, 0);
    for (Eigen::Index lag = 1; lag < lags; ++lag) {
      const double bartlett = 1.0 - static_cast<double>(lag) / static_cast<double>(lags);
      exact += 2.0 * bartlett * product(values, lag) * product(weights, lag);
    }
    exact /= static_cast<double>(kCount);
    EXPECT_GT(lags, correlation > 0.0 ? 200 : 3) << "control: no long correlation";
    // Rounding of the transform, on sums that cancel to a hundredth.
    EXPECT_NEAR(ColouredNoise{values}.variances_along(weights)[0], exact, 1e-10 * exact) << correlation;
  }
}

}  // namespace
}  // namespace hybridtest
