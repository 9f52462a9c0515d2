#include "experimental_site/tracking_indicator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/random.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0e-3;
constexpr double kWindow_s = 1.0;

SiteVector one(double value) { return SiteVector::Constant(1, value); }

/// After so many windows the mean of what was before the sine is below 1e-5 of it.
double settled_lag_sine(double amplitude_m, double frequency_hz, double phase_lag, double gain = 1.0) {
  TrackingIndicator indicator{1, kPeriod_s, kWindow_s, 0.0};
  for (int i = 0; i < 12000; ++i) {
    const double angle = 2.0 * std::numbers::pi * frequency_hz * kPeriod_s * i;
    indicator.sample(one(amplitude_m * std::sin(angle)), one(gain * amplitude_m * std::sin(angle - phase_lag)));
  }
  return indicator.lag_sine();
}

TEST(TrackingIndicatorTest, EqualsSineOfTheLagForAnySine) {
  for (const double frequency_hz : {2.0, 5.0, 20.0}) {
    for (const double lag : {-0.3, 0.05, 0.4}) {
      for (const double amplitude_m : {1e-3, 0.1}) {
        const double half_angle = std::numbers::pi * frequency_hz * kPeriod_s;
        // An exponential window of 1 s leaves of the ripple at twice the frequency 1/(2 omega T),
        // in the mean of the squares: half of that in each root.
        const double ripple = 1.0 / (4.0 * std::numbers::pi * frequency_hz * kWindow_s);
        EXPECT_NEAR(settled_lag_sine(amplitude_m, frequency_hz, lag), std::sin(lag) * std::cos(half_angle),
                    ripple * std::abs(std::sin(lag)))
            << frequency_hz << " Hz, lag " << lag;
      }
    }
  }
}

TEST(TrackingIndicatorTest, DelayGivesPhaseAndGainMultiplies) {
  const double lag = 2.0 * std::numbers::pi * 5.0 * 0.010;  // 10 ms at 5 Hz
  EXPECT_NEAR(settled_lag_sine(0.01, 5.0, lag, 2.0) / settled_lag_sine(0.01, 5.0, lag), 2.0, 1e-12);
  EXPECT_EQ(settled_lag_sine(0.01, 5.0, 0.0), 0.0) << "a perfect actuator: both products are the same";
}

TEST(TrackingIndicatorTest, ForgetsPastLag) {
  TrackingIndicator indicator{1, kPeriod_s, kWindow_s, 0.0};
  const auto shake = [&](double lag, int from, int to) {
    for (int i = from; i < to; ++i) {
      const double angle = 2.0 * std::numbers::pi * 5.0 * kPeriod_s * i;
      indicator.sample(one(std::sin(angle)), one(std::sin(angle - lag)));
    }
  };
  shake(0.5, 0, 10000);
  EXPECT_GT(indicator.lag_sine(), 0.4);
  shake(0.0, 10000, 15000);
  // exp(-5) of it is left, and what the change of lag itself added.
  EXPECT_LT(std::abs(indicator.lag_sine()), 0.01);
}

TEST(TrackingIndicatorTest, NoiseAtRestGivesNoLag) {
  TrackingIndicator indicator{1, kPeriod_s, kWindow_s, 0.005};
  Random random{3};
  double worst = 0.0;
  for (int i = 0; i < 10000; ++i) {
    indicator.sample(one(0.02), one(0.02 + random.uniform(-1e-5, 1e-5)));
    worst = std::max(worst, std::abs(indicator.lag_sine()));
  }
  // Growth 0.02 * 1e-5, over displacement 0.02 times a change of 5e-6: without the least motion it
  // would have no bound at all.
  EXPECT_LT(worst, 0.1);
  EXPECT_GT(worst, 0.0);
}

TEST(TrackingIndicatorTest, ReturnsWorstDegreeOfFreedom) {
  TrackingIndicator both{2, kPeriod_s, kWindow_s, 0.0};
  TrackingIndicator second{1, kPeriod_s, kWindow_s, 0.0};
  for (int i = 0; i < 5000; ++i) {
    const double angle = 2.0 * std::numbers::pi * 5.0 * kPeriod_s * i;
    SiteVector wanted = SiteVector::Constant(2, std::sin(angle));
    SiteVector measured = wanted;
    measured[1] = std::sin(angle + 0.2);
    both.sample(wanted, measured);
    second.sample(wanted.tail(1), measured.tail(1));
  }
  EXPECT_EQ(both.lag_sine(), second.lag_sine());
  EXPECT_LT(both.lag_sine(), -0.15) << "it leads";
}

}  // namespace
}  // namespace hybridtest
