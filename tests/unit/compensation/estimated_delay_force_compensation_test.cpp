#include "compensation/estimated_delay_force_compensation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "compensation/delay_estimators/fixed_delay.hpp"
#include "compensation/delay_estimators/recursive_least_squares.hpp"
#include "compensation/force_correction.hpp"
#include "compensation/polynomial_force.hpp"
#include "core/config_error.hpp"
#include "tests/unit/compensation/delayed_motion.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 1024.0;

std::unique_ptr<DelayEstimator> least_squares() {
  RecursiveLeastSquares::Parameters parameters;
  parameters.limits.initial_delay_s = 0.008;
  return std::make_unique<RecursiveLeastSquares>(parameters, kPeriod_s);
}

std::unique_ptr<ForceCompensator> polynomial() {
  return std::make_unique<PolynomialForce>(PolynomialForce::Parameters{3, 0.008, 0.020}, kPeriod_s);
}

TEST(EstimatedDelayForceCompensation, EstimatesForceDelay) {
  constexpr double kLag_s = 17.3e-3;
  EstimatedDelayForceCompensation compensation{polynomial(), least_squares()};
  const auto force_n = [](double t) { return 5e3 * std::sin(2.0 * std::numbers::pi * 2.0 * t + 0.3); };
  double worst_n = 0.0;
  for (int i = 0; i < 10 * 1024; ++i) {
    const double t = kPeriod_s * i;
    const double answer_n =
        compensation.corrected_force({sine_m(2.0, t), sine_m(2.0, t - kLag_s), force_n(t - kLag_s)});
    if (i > 9 * 1024) worst_n = std::max(worst_n, std::abs(answer_n - force_n(t)));
  }
  EXPECT_NEAR(compensation.delay_s(), kLag_s, 2e-6);
  // The extrapolation of a sine of 2 Hz by 17.3 ms through points 20 ms apart is off by 0.75 (w T)^4 = 0.3 %.
  EXPECT_LT(worst_n, 0.003 * 5e3);
}

TEST(EstimatedDelayForceCompensation, ResetRestoresInitialState) {
  EstimatedDelayForceCompensation used{polynomial(), least_squares()};
  EstimatedDelayForceCompensation fresh{polynomial(), least_squares()};
  const auto sample = [](int i) {
    const double t = kPeriod_s * i;
    return ForceSample{sine_m(2.0, t), sine_m(2.0, t - 0.03), 100.0 * std::cos(9.0 * t)};
  };
  for (int i = 0; i < 3000; ++i) static_cast<void>(used.corrected_force(sample(i)));
  used.reset();
  for (int i = 0; i < 3000; ++i) ASSERT_EQ(used.corrected_force(sample(i)), fresh.corrected_force(sample(i)));
}

TEST(EstimatedDelayForceCompensation, RejectsMethodWithoutDelay) {
  auto correction = std::make_unique<ForceCorrection>(ForceCorrection::Parameters{}, kPeriod_s);
  EXPECT_THROW((EstimatedDelayForceCompensation{std::move(correction), least_squares()}), ConfigError);
  EXPECT_THROW((EstimatedDelayForceCompensation{polynomial(), nullptr}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
