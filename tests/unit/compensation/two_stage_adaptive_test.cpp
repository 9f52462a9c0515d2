#include "compensation/two_stage_adaptive.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "compensation/polynomial_displacement.hpp"
#include "core/config_error.hpp"
#include "core/random.hpp"
#include "tests/unit/compensation/frequency_response.hpp"
#include "tests/unit/compensation/second_order_actuator.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 1024.0;

TwoStageAdaptive::Parameters coarse(double delay_s) {
  TwoStageAdaptive::Parameters parameters;
  parameters.coarse_delay_s = delay_s;
  return parameters;
}

TEST(TwoStageAdaptive, EqualsPolynomialBeforeLearning) {
  constexpr double kDelay_s = 20 * kPeriod_s;
  const auto closed_form = [](double omega) {
    const Complex z = std::polar(1.0, -omega * kDelay_s);
    return 4.0 - 6.0 * z + 4.0 * z * z - z * z * z;
  };
  // harmonic_input measures nothing.
  expect_frequency_response(
      [] {
        return TwoStageAdaptive{coarse(kDelay_s), kPeriod_s};
      },
      closed_form, [](double) { return 1e-12; },  // rounding, 15 times
      kPeriod_s, 60);
}

TEST(TwoStageAdaptive, IsTheIdentityAtZeroDelayBeforeLearning) {
  TwoStageAdaptive compensator{coarse(0.0), kPeriod_s};
  for (int i = 0; i < 100; ++i) {
    const double target_m = std::sin(0.7 * i * i);
    ASSERT_EQ(compensator.command({target_m, 0.0, 0.0, 0.0, 0.0}), target_m);
  }
}

template <class Compensator>
double worst_error(Compensator&& compensator, double noise_m) {
  SecondOrderActuator actuator{1.05, 0.022, 1.5e-4};
  Random random{5};
  double measured_m = 0.0;
  double worst_m = 0.0;
  for (int i = 0; i < 12 * 1024; ++i) {
    CompensatorInput input;
    for (const double frequency_hz : {0.9, 2.3}) {
      input.target_m += 5e-3 * std::sin(2.0 * std::numbers::pi * frequency_hz * kPeriod_s * i);
    }
    if (i > 8 * 1024) worst_m = std::max(worst_m, std::abs(actuator.displacement_m - input.target_m));
    input.measured_displacement_m = measured_m;
    measured_m = actuator.displacement_m + noise_m * random.normal();
    actuator.advance(compensator.command(input), kPeriod_s);
  }
  return worst_m / 10e-3;
}

TEST(TwoStageAdaptive, CompensatesResidualOfPolynomial) {
  // Actuator of amplitude 1/1.05 and a delay of 21 ms, coarse delay of 20 ms. The amplitude alone leaves the
  // polynomial with 5 %.
  const double polynomial = worst_error(PolynomialDisplacement{{3, 0.020, 0.0}, kPeriod_s}, 0.0);
  EXPECT_GT(polynomial, 0.045);
  // Three terms at two frequencies have three of four equations; the rest is what the prior leaves.
  EXPECT_LT(worst_error(TwoStageAdaptive{coarse(0.020), kPeriod_s}, 0.0), 0.1 * polynomial);
  EXPECT_LT(worst_error(TwoStageAdaptive{coarse(0.020), kPeriod_s}, 16e-6), 0.2 * polynomial);
}

TEST(TwoStageAdaptive, BoundsItsCoefficients) {
  TwoStageAdaptive::Parameters parameters = coarse(0.020);
  parameters.theta_max = 1.2;
  TwoStageAdaptive compensator{parameters, kPeriod_s};
  for (int i = 0; i < 5000; ++i) {
    // Five times as small as commanded.
    static_cast<void>(compensator.command({std::sin(0.02 * i), 0.0, 0.0, 0.2 * std::sin(0.02 * i - 0.4), 0.0}));
    ASSERT_LE(compensator.theta().cwiseAbs().maxCoeff(), 1.2);
  }
  EXPECT_EQ(compensator.theta().cwiseAbs().maxCoeff(), 1.2);
}

TEST(TwoStageAdaptive, RejectsParametersOutOfRange) {
  const auto refuses = [](auto change) {
    TwoStageAdaptive::Parameters parameters;
    change(parameters);
    EXPECT_THROW((TwoStageAdaptive{parameters, kPeriod_s}), ConfigError);
  };
  refuses([](auto& p) { p.coarse_delay_s = -0.01; });
  refuses([](auto& p) { p.term_spacing_s = 0.0; });
  refuses([](auto& p) { p.memory_s = 0.0; });
  refuses([](auto& p) { p.filter_hz = 600.0; });
  refuses([](auto& p) { p.equation_error_m = 0.0; });
  refuses([](auto& p) { p.theta_deviation = 0.0; });
  refuses([](auto& p) { p.theta_max = 0.5; });
}

}  // namespace
}  // namespace hybridtest
