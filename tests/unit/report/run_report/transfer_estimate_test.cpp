#include "report/run_report/transfer_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/random.hpp"

namespace hybridtest::run_report {
namespace {

constexpr double kPeriod_s = 0.001;

constexpr double kSegment_s = 4.096;

/// Sines of 1 to 11.7 Hz, each with whole periods in a segment: so nothing leaks from one to another.
double broad(double time_s) {
  double sum = 0.0;
  for (int k = 1; k <= 12; ++k) {
    sum += std::sin(2.0 * std::numbers::pi * 4.0 * k / kSegment_s * time_s + 1.3 * k * k) / static_cast<double>(k);
  }
  return sum;
}

TransferEstimate estimate_of(double amplitude, double delay_s, double noise) {
  TransferEstimate estimate{kPeriod_s, 4096};
  Random random{3};
  for (int i = 0; i < 40'000; ++i) {
    const double time_s = kPeriod_s * i;
    estimate.add(broad(time_s), amplitude * broad(time_s - delay_s) + noise * random.normal());
  }
  return estimate;
}

TEST(TransferEstimate, FindsDelayAndAmplitude) {
  const auto points = estimate_of(0.9, 0.0125, 0.0).points();
  ASSERT_GT(points.size(), 20U);
  for (const TransferPoint& point : points) {
    // Beside a line the window shows its phase at another frequency.
    if (std::lround(point.frequency_hz * kSegment_s) % 4 != 0) continue;
    EXPECT_NEAR(point.delay_s, 0.0125, 1e-6) << point.frequency_hz;
    EXPECT_NEAR(point.amplitude, 0.9, 1e-6) << point.frequency_hz;
  }
}

TEST(TransferEstimate, NoiseIsNotShownAsTracking) {
  for (const TransferPoint& point : estimate_of(1.0, 0.0, 0.05).points()) {
    EXPECT_LT(point.frequency_hz, 14.0);
    EXPECT_GE(point.coherence, 0.8);
  }
  EXPECT_GT(estimate_of(1.0, 0.0, 0.0).points().size(), estimate_of(1.0, 0.0, 5.0).points().size()) << "control";
}

TEST(TransferEstimate, OneSegmentIsNotEnough) {
  TransferEstimate estimate{kPeriod_s, 1024};
  for (int i = 0; i < 1024; ++i) estimate.add(broad(kPeriod_s * i), broad(kPeriod_s * i));
  EXPECT_TRUE(estimate.points().empty());
  for (int i = 1024; i < 1536; ++i) estimate.add(broad(kPeriod_s * i), broad(kPeriod_s * i));
  EXPECT_FALSE(estimate.points().empty());
}

TEST(TransferEstimate, AGapBeginsTheSegmentAnew) {
  TransferEstimate estimate{kPeriod_s, 1024};
  for (int i = 0; i < 10'000; ++i) {
    const double value = i % 1000 == 0 ? std::nan("") : broad(kPeriod_s * i);
    estimate.add(value, value);
  }
  EXPECT_TRUE(estimate.points().empty());
}

}  // namespace
}  // namespace hybridtest::run_report
