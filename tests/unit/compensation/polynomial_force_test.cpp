#include "compensation/polynomial_force.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "compensation/no_force_compensation.hpp"
#include "core/config_error.hpp"
#include "tests/unit/compensation/frequency_response.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 1024.0;

double corrected(ForceCompensator& compensator, double force_n) {
  return compensator.corrected_force({0.01, 0.02, force_n});
}

TEST(PolynomialForce, IsTheIdentityAtZeroDelay) {
  for (int order = 1; order <= 4; ++order) {
    PolynomialForce compensator{{order, 0.0, 0.0}, kPeriod_s};
    for (int i = 0; i < 50; ++i) {
      const double force_n = std::sin(0.7 * i * i);
      ASSERT_EQ(corrected(compensator, force_n), force_n);
    }
  }
}

TEST(PolynomialForce, IsExactForPolynomialsOfItsOrder) {
  const auto polynomial = [](int order, double time_s) {
    double value = 0.0;
    for (int k = order; k >= 0; --k) value = value * time_s + 1.0 / (k + 1.0);
    return value;
  };
  for (const double delay_s : {0.0, 0.4e-3, 1.5 * kPeriod_s, 7.3e-3, 20e-3}) {
    for (int order = 1; order <= 4; ++order) {
      PolynomialForce compensator{{order, delay_s, 4 * kPeriod_s}, kPeriod_s};
      for (int i = 0; i < 200; ++i) {
        const double force_n = corrected(compensator, polynomial(order, kPeriod_s * i));
        if (i < order * 4) continue;
        // Rounding, as the weights amplify it.
        ASSERT_NEAR(force_n, polynomial(order, kPeriod_s * i + delay_s), 1e-15 * (1.0 + compensator.noise_gain()));
      }
    }
  }
}

TEST(PolynomialForce, HasTheFrequencyResponseOfBackwardDifferences) {
  constexpr int kSpacing = 4;
  const double ahead = 1.5 / kSpacing;  // a sample late, and held over one
  const auto closed_form = [&](double omega) {
    const Complex difference = 1.0 - std::polar(1.0, -omega * kSpacing * kPeriod_s);
    return 1.0 + ahead * difference + ahead * (ahead + 1.0) / 2.0 * difference * difference;
  };
  expect_frequency_response(
      [&] {
        return PolynomialForce{{2, 1.5 * kPeriod_s, kSpacing * kPeriod_s}, kPeriod_s};
      },
      closed_form, [](double) { return 1e-13; },  // rounding
      kPeriod_s, 2 * kSpacing);
}

TEST(PolynomialForce, RejectsParametersOutOfRange) {
  EXPECT_THROW((PolynomialForce{{0, 0.01, 0.0}, kPeriod_s}), ConfigError);
  EXPECT_THROW((PolynomialForce{{5, 0.01, 0.0}, kPeriod_s}), ConfigError);
  EXPECT_THROW((PolynomialForce{{2, -0.01, 0.0}, kPeriod_s}), ConfigError);
  EXPECT_THROW((PolynomialForce{{2, std::nan(""), 0.0}, kPeriod_s}), ConfigError);
  EXPECT_THROW((PolynomialForce{{2, 0.01, 0.0}, 0.0}), ConfigError);
  EXPECT_THROW((PolynomialForce{{2, 0.01, 0.0}, 2.0}), ConfigError);
}

TEST(NoForceCompensation, ReturnsMeasuredForce) {
  NoForceCompensation none;
  EXPECT_EQ(corrected(none, 123.456), 123.456);
}

}  // namespace
}  // namespace hybridtest
