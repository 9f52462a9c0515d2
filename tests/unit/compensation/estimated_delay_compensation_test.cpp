#include "compensation/estimated_delay_compensation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "compensation/adaptive_inverse.hpp"
#include "compensation/delay_estimators/cross_correlation.hpp"
#include "compensation/delay_estimators/fixed_delay.hpp"
#include "compensation/delay_estimators/frequency_evaluation_index.hpp"
#include "compensation/delay_estimators/recursive_least_squares.hpp"
#include "compensation/delay_estimators/zero_crossing_slope.hpp"
#include "compensation/inverse_compensation.hpp"
#include "compensation/linear_acceleration.hpp"
#include "compensation/newmark_kinematics.hpp"
#include "compensation/polynomial_displacement.hpp"
#include "core/config_error.hpp"
#include "tests/unit/compensation/delay_line.hpp"
#include "tests/unit/compensation/frequency_response.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 1024.0;
constexpr double kDelay_s = 17.3e-3;
const DelayLimits kLimits{0.008, 0.0, 0.1, 0.02};

template <class Estimator>
std::unique_ptr<DelayEstimator> estimator() {
  typename Estimator::Parameters parameters;
  parameters.limits = kLimits;
  return std::make_unique<Estimator>(parameters, kPeriod_s);
}

/// Greatest tracking error of the last second of ten, of the amplitude.
double tracking_error(Compensator& compensator) {
  DelayLine actuator{kDelay_s, kPeriod_s};
  const double omega = 2.0 * std::numbers::pi * 2.0;
  double measured_m = 0.0;
  double worst_m = 0.0;
  for (int i = 0; i < 10 * 1024; ++i) {
    CompensatorInput input = harmonic_input(omega, 5e-3 * std::polar(1.0, omega * kPeriod_s * i));
    input.measured_displacement_m = measured_m;
    measured_m = actuator.advance(compensator.command(input));
    if (i >= 9 * 1024) worst_m = std::max(worst_m, std::abs(measured_m - input.target_m));
  }
  return worst_m / 5e-3;
}

template <class Estimator>
class EstimatedDelay : public testing::Test {};
using Estimators = testing::Types<ZeroCrossingSlope, CrossCorrelation, FrequencyEvaluationIndex, RecursiveLeastSquares>;
TYPED_TEST_SUITE(EstimatedDelay, Estimators);

TYPED_TEST(EstimatedDelay, FindsTheDelayThatItsCompensatorNeeds) {
  // Points 20 ms apart; extrapolated by 17.3 ms a sine of 2 Hz is off by
  // s (s + 1) (s + 2) (s + 3) / 24 (w T)^4 = 0.75 * 0.004 of itself, s = 0.845. A delay known to 20 us adds w times
  // that, 0.025 %.
  auto polynomial =
      std::make_unique<PolynomialDisplacement>(PolynomialDisplacement::Parameters{3, 0.008, 0.020}, kPeriod_s);
  EstimatedDelayCompensation compensation{std::move(polynomial), estimator<TypeParam>()};
  EXPECT_DOUBLE_EQ(compensation.delay_s(), 0.008);
  EXPECT_LT(tracking_error(compensation), 0.0035);
  EXPECT_NEAR(compensation.delay_s(), kDelay_s, 2e-5);
}

TEST(EstimatedDelayCompensation, DrivesEveryCompensatorThatHasADelay) {
  const auto error_with = [](std::unique_ptr<Compensator> compensator) {
    EstimatedDelayCompensation compensation{std::move(compensator), estimator<RecursiveLeastSquares>()};
    const double error = tracking_error(compensation);
    EXPECT_NEAR(compensation.delay_s(), kDelay_s, 2e-5);
    return error;
  };
  // The next term of each method's Taylor series, w delay = 0.217: third, fourth and second.
  EXPECT_LT(error_with(std::make_unique<NewmarkKinematics>(NewmarkKinematics::Parameters{0.008, 0.0}, kPeriod_s)),
            1.8e-3);
  EXPECT_LT(error_with(std::make_unique<LinearAcceleration>(LinearAcceleration::Parameters{0.008, 0.0}, kPeriod_s)),
            7e-4);
  EXPECT_LT(error_with(std::make_unique<InverseCompensation>(InverseCompensation::Parameters{0.008}, kPeriod_s)),
            2.7e-2);
}

TEST(EstimatedDelayCompensation, AddsTheNetwork) {
  auto newmark = std::make_unique<NewmarkKinematics>(NewmarkKinematics::Parameters{}, kPeriod_s);
  EstimatedDelayCompensation compensation{std::move(newmark), estimator<FixedDelay>()};
  compensation.set_network_latency(0.005);
  const CompensatorInput unit_velocity{0.0, 1.0, 0.0, 0.0, 0.0};
  for (int i = 0; i < 1024; ++i) static_cast<void>(compensation.command(unit_velocity));
  EXPECT_DOUBLE_EQ(compensation.command(unit_velocity), 0.013);
}

TEST(EstimatedDelayCompensation, ResetRestoresInitialState) {
  const auto make = [] {
    auto inner =
        std::make_unique<PolynomialDisplacement>(PolynomialDisplacement::Parameters{3, 0.008, 0.020}, kPeriod_s);
    return EstimatedDelayCompensation{std::move(inner), estimator<ZeroCrossingSlope>()};
  };
  EstimatedDelayCompensation used = make();
  static_cast<void>(tracking_error(used));
  used.reset();
  EstimatedDelayCompensation fresh = make();
  EXPECT_EQ(used.delay_s(), fresh.delay_s());
  EXPECT_EQ(tracking_error(used), tracking_error(fresh));
}

TEST(EstimatedDelayCompensation, RejectsUnsupportedCompensatorAndSaysWhy) {
  const auto refused = [](std::unique_ptr<Compensator> compensator, std::unique_ptr<DelayEstimator> with) {
    try {
      const EstimatedDelayCompensation compensation{std::move(compensator), std::move(with)};
    } catch (const ConfigError& error) {
      return std::string{error.what()};
    }
    return std::string{};
  };
  EXPECT_NE(
      refused(std::make_unique<AdaptiveInverse>(AdaptiveInverse::Parameters{}, kPeriod_s), estimator<FixedDelay>())
          .find("expected one of polynomial_displacement"),
      std::string::npos);
  EXPECT_NE(refused(std::make_unique<NewmarkKinematics>(NewmarkKinematics::Parameters{}, kPeriod_s), nullptr), "");
  // Points a period apart reach eight periods, 7.8 ms, ahead.
  EXPECT_NE(
      refused(std::make_unique<PolynomialDisplacement>(PolynomialDisplacement::Parameters{3, 0.0, 0.0}, kPeriod_s),
              estimator<FixedDelay>())
          .find("widen its point_spacing_s"),
      std::string::npos);
}

}  // namespace
}  // namespace hybridtest
