#include "compensation/delay_estimators/frequency_evaluation_index.hpp"

#include <gtest/gtest.h>

#include <complex>
#include <numbers>

#include "core/config_error.hpp"
#include "tests/unit/compensation/delayed_motion.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 1024.0;

// Between two of the window's frequencies a sine's other half, at -f, is seen through Hann's window: 2 f = 6 lines
// away, where its products with the first are below 2e-4 of the whole. That is an angle at f = 3 Hz.
constexpr double kTolerance_s = 2e-4 / (2.0 * std::numbers::pi * 3.0);

TEST(FrequencyEvaluationIndex, EstimatesFractionalDelay) {
  for (const double frequency_hz : {3.0, 3.37, 3.5}) {
    for (const double delay_s : {0.3 * kPeriod_s, 12.34e-3, 43.21e-3}) {
      FrequencyEvaluationIndex estimator{{}, kPeriod_s};
      const auto motion = [&](double t) { return sine_m(frequency_hz, t); };
      EXPECT_NEAR(estimate_of(estimator, motion, delay_s, kPeriod_s, 10.0), delay_s, kTolerance_s) << frequency_hz;
      EXPECT_NEAR(estimator.frequency_hz(), frequency_hz, 1e-3);
      EXPECT_NEAR(estimator.amplitude(), 1.0, 1e-4);
    }
  }
}

TEST(FrequencyEvaluationIndex, IsThePublishedIndexOfTwoTones) {
  // FEI = sum of P exp(-i w delay) / sum of P, f_eq = sum of P f / sum of P, P the powers 1 and 1/4.
  constexpr double kDelay_s = 20e-3;
  const auto motion = [](double t) { return sine_m(2.0, t) + 0.5 * sine_m(7.0, t); };
  const double turn = -2.0 * std::numbers::pi * kDelay_s;
  const std::complex<double> index = (std::polar(1.0, 2.0 * turn) + 0.25 * std::polar(1.0, 7.0 * turn)) / 1.25;
  const double frequency_hz = (2.0 + 0.25 * 7.0) / 1.25;
  const double expected_s = -std::arg(index) / (2.0 * std::numbers::pi * frequency_hz);
  FrequencyEvaluationIndex estimator{{}, kPeriod_s};
  EXPECT_NEAR(estimate_of(estimator, motion, kDelay_s, kPeriod_s, 10.0), expected_s, kTolerance_s);
  EXPECT_NEAR(estimator.amplitude(), std::abs(index), 1e-3);
  EXPECT_NEAR(estimator.frequency_hz(), frequency_hz, 1e-2);
}

TEST(FrequencyEvaluationIndex, EstimatesDelayOfChirp) {
  FrequencyEvaluationIndex estimator{{}, kPeriod_s};
  // The frequency moves by 0.2 Hz in a window; the delayed chirp is taken from a window 18 ms earlier, in which the
  // frequency weighed is lower by 0.2 Hz/s * 18 ms / 2 of 5 Hz.
  EXPECT_NEAR(estimate_of(estimator, chirp_m, 17.77e-3, kPeriod_s, 20.0), 17.77e-3, 17.77e-3 * 1e-3);
}

TEST(FrequencyEvaluationIndex, SeparatesGainAndDelay) {
  FrequencyEvaluationIndex estimator{{}, kPeriod_s};
  const auto motion = [](double t) { return sine_m(3.0, t); };
  EXPECT_NEAR(estimate_of(estimator, motion, 17.77e-3, kPeriod_s, 10.0, 0.7), 17.77e-3, kTolerance_s);
  EXPECT_NEAR(estimator.amplitude(), 0.7, 1e-4);
}

TEST(FrequencyEvaluationIndex, AveragesNoise) {
  FrequencyEvaluationIndex estimator{{}, kPeriod_s};
  const double estimate_s = estimate_of(
      estimator, [](double t) { return sine_m(3.0, t); }, 17.77e-3, kPeriod_s, 10.0, 1.0, 16e-6);
  // Hann's window counts for 1024 / 1.94 samples: 16e-6 / (0.067 sqrt(527)) = 10.4 us. Three deviations.
  EXPECT_NEAR(estimate_s, 17.77e-3, 32e-6);
}

TEST(FrequencyEvaluationIndex, IsIndependentOfSensorOffset) {
  FrequencyEvaluationIndex::Parameters parameters;
  parameters.frequency_hz_min = 2.0;  // Hann's window leaves nothing of a constant beyond its first line
  FrequencyEvaluationIndex estimator{parameters, kPeriod_s};
  double estimate_s = 0.0;
  for (int i = 0; i < 10 * 1024; ++i) {
    const double t = kPeriod_s * i;
    estimate_s = estimator.estimate({sine_m(4.0, t), sine_m(4.0, t - 17.77e-3) + 2e-3});
  }
  EXPECT_NEAR(estimate_s, 17.77e-3, kTolerance_s);
}

TEST(FrequencyEvaluationIndex, DoesNotUpdateBelowMinimumMotion) {
  FrequencyEvaluationIndex::Parameters parameters;
  parameters.motion_m_min = 3.6e-3;  // 5 mm are 3.54 in the root mean square
  FrequencyEvaluationIndex estimator{parameters, kPeriod_s};
  const auto motion = [](double t) { return sine_m(3.0, t); };
  EXPECT_EQ(estimate_of(estimator, motion, 43e-3, kPeriod_s, 10.0), 20e-3);
  parameters.motion_m_min = 3.5e-3;
  FrequencyEvaluationIndex other{parameters, kPeriod_s};
  EXPECT_NEAR(estimate_of(other, motion, 43e-3, kPeriod_s, 10.0), 43e-3, kTolerance_s);
}

TEST(FrequencyEvaluationIndex, RejectsParametersOutOfRange) {
  const auto refuses = [](auto change) {
    FrequencyEvaluationIndex::Parameters parameters;
    change(parameters);
    EXPECT_THROW((FrequencyEvaluationIndex{parameters, kPeriod_s}), ConfigError);
  };
  refuses([](auto& p) { p.window_s = 0.01; });
  refuses([](auto& p) { p.frequency_hz_max = 500.0; });
  refuses([](auto& p) { p.frequency_hz_max = 0.5; });  // no multiple of 1/window in the band
  refuses([](auto& p) { p.frequency_hz_min = 30.0; });
  refuses([](auto& p) { p.motion_m_min = 0.0; });
}

}  // namespace
}  // namespace hybridtest
